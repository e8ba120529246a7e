"""`python -m goalkeeper.bench`: see goalkeeper.app.bench."""

import sys

from goalkeeper.app.bench import main

if __name__ == "__main__":
    sys.exit(main())
