"""Entry point of the command `mocapd`: sets up signals and libraries, runs the command, returns its exit code."""

import errno
import gc
import io
import os
import sys
from pathlib import Path

from mocapd.app.daemon.early_signals import SIGINT_EXIT, end_at_once, ignore_signals, interruptible

# The libraries read these during import. At our array sizes a thread pool costs more than it gains: we use one
# thread per camera, and one thread in each library.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("MKL_NUM_THREADS", "1")
# Else pydantic reads the metadata of every installed package, to find plug-ins that we do not use.
os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
# Imports and a tracker's building allocate a million containers that stay: with Python's threshold of 700 the cyclic
# collector walks them again and again, for a tenth of the start's time.
gc.set_threshold(20_000)

_FULL = (errno.ENOSPC, errno.EDQUOT)


def main() -> None:
    """Run one command. A MocapdError becomes one line on stderr and its exit code."""
    end_at_once(sys.argv)  # before the slow imports

    import mocapd.capture.environment  # noqa: F401  what cv2 reads while it is imported
    from mocapd.cli.care.completion import ready_to_complete
    from mocapd.cli.command_line.removed_options import refuse_removed_options
    from mocapd.cli.command_list import app
    from mocapd.errors import CannotCreateError, MocapdError

    interruptible(sys.argv)
    if isinstance(sys.stdout, io.TextIOWrapper):  # None where it is closed
        # as stderr does: a terminal whose letters are not those of a path or of a camera's name ends no command
        sys.stdout.reconfigure(errors="backslashreplace")
    ready_to_complete()
    try:
        refuse_removed_options(sys.argv[1:])
        try:
            app(prog_name="mocapd")
        finally:
            _flush_output()
    except BrokenPipeError:  # of the flush: typer exits with the same code for those of the command
        _drop_output()
        sys.exit(1)
    except OSError as error:
        if error.errno not in _FULL or error.filename is not None:
            raise
        _drop_output()
        print(
            f"mocapd: the output cannot be written ({error.strerror}) -- make room", file=sys.stderr
        )
        sys.exit(CannotCreateError.exit_code)
    except MocapdError as error:
        print(f"mocapd: {error}", file=sys.stderr)
        sys.exit(error.exit_code)
    except KeyboardInterrupt:
        sys.exit(SIGINT_EXIT)
    finally:
        ignore_signals()


def _flush_output() -> None:
    """Writes what is left, while errors can still be reported: at exit Python prints its own message."""
    if sys.stdout is not None and not sys.stdout.closed:
        sys.stdout.flush()


def _drop_output() -> None:
    """Else Python tries again at exit, and exits with 120."""
    with Path(os.devnull).open("wb") as nowhere:
        os.dup2(nowhere.fileno(), sys.stdout.fileno())


if __name__ == "__main__":
    main()
