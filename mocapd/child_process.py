"""Processes that end when the process that started them ends, also when that is killed.

Linux sends the signal (PR_SET_PDEATHSIG) that the child asked for. The alternative is a pipe whose end the child watches; it
needs a thread, which does not run while a compiler holds the interpreter's lock, and every fork that keeps the other
end open defeats it. Systems without prctl have only the parent's ordinary clean-up, so a parent ends its children on
SIGTERM and SIGHUP, too.
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
    """Called by a child before its work: when the process `parent_pid` ends, the child gets this signal.

    The signal comes when the parent's thread that started the child ends, so that must be a thread that outlives it.
    """
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, number)
    if os.getppid() != parent_pid:  # it ended before we asked
        os._exit(1)


def child_command(program: str, *arguments: str) -> list[str]:
    """The command line of a Python process that gets SIGTERM when the calling process ends.

    program: Python statements that run it, with `sys` imported; arguments: its `sys.argv[1:]`.
    """
    began = str(os.getpid()), str(int(signal.SIGTERM))
    return [sys.executable, "-c", _BEGIN + program, *began, *arguments]
