"""The entry of the command `mocapd`: quiet libraries first, then the command, then its exit code."""

import os
import sys

# Read by the libraries while they are imported. A pool of threads costs more than it brings at the
# sizes met here: one thread per camera, and the libraries at one each.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("MKL_NUM_THREADS", "1")

import mocapd.capture.environment  # noqa: F401  what cv2 reads while it is imported
from mocapd.cli.app import app
from mocapd.errors import MocapdError

SIGINT_EXIT = 130


def main() -> None:
    """Run one command. An expected trouble is one line on stderr; its code is the exit code."""
    try:
        app(prog_name="mocapd")
    except MocapdError as error:
        print(f"mocapd: {error}", file=sys.stderr)
        sys.exit(error.exit_code)
    except KeyboardInterrupt:
        sys.exit(SIGINT_EXIT)


if __name__ == "__main__":
    main()
