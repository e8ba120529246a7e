"""`python -m goalkeeper`"""

import sys

from goalkeeper.app.main import main

if __name__ == "__main__":
    sys.exit(main())
