"""Child processes that end with their parent, even if it is killed.

The child requests a signal from Linux (PR_SET_PDEATHSIG). The alternative, a pipe watched by the child, needs a thread,
which stops while a compiler holds the interpreter's lock, and any fork that inherits the other end defeats it. Systems
without prctl have only the parent's clean-up, so a parent also ends its children on SIGTERM and SIGHUP.
"""

import ctypes
import os
import signal
import sys

_PR_SET_PDEATHSIG = 1  # linux/prctl.h
_BEGIN = (
    "import sys; from mocapd.child_process import end_with_parent; "
    "end_with_parent(int(sys.argv.pop(1)), int(sys.argv.pop(1))); "
)


def end_with_parent(parent_pid: int, number: int) -> None:
    """Call in a child before its work: when the process `parent_pid` ends, the child gets the signal `number`.

    The signal comes at the end of the parent's thread that started the child, so that thread must outlive the child.
    """
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, number)
    if os.getppid() != parent_pid:  # the parent ended before the request
        os._exit(1)


def child_command(program: str, *arguments: str) -> list[str]:
    """The command line of a Python process that gets SIGTERM at the end of the calling process.

    program: Python statements, with `sys` imported; arguments: its `sys.argv[1:]`. -P: no imports from the working
    directory, which may be anybody's.
    """
    began = str(os.getpid()), str(int(signal.SIGTERM))
    return [sys.executable, "-P", "-c", _BEGIN + program, *began, *arguments]
