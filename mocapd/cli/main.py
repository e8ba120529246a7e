"""The entry of the command `mocapd`: signals and quiet libraries first, then the command, its exit code."""

import os
import sys

from mocapd.app.daemon.early_signals import SIGINT_EXIT, end_at_once, ignore_signals, interruptible

# Read by the libraries while they are imported. A pool of threads costs more than it brings at the
# sizes met here: one thread per camera, and the libraries at one each.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("MKL_NUM_THREADS", "1")


def main() -> None:
    """Run one command. An expected trouble is one line on stderr; its code is the exit code."""
    end_at_once(sys.argv)  # before the imports, which take long

    import mocapd.capture.environment  # noqa: F401  what cv2 reads while it is imported
    from mocapd.cli.care.completion import ready_to_complete
    from mocapd.cli.command_list import app
    from mocapd.errors import MocapdError

    interruptible(sys.argv)
    ready_to_complete()
    try:
        app(prog_name="mocapd")
    except MocapdError as error:
        print(f"mocapd: {error}", file=sys.stderr)
        sys.exit(error.exit_code)
    except KeyboardInterrupt:
        sys.exit(SIGINT_EXIT)
    finally:
        ignore_signals()


if __name__ == "__main__":
    main()
