"""`python -m mocapd_analysis`"""

from mocapd_analysis.main import main

main()
