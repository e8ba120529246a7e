"""Processes that tests look at from outside."""

import psutil


def still_runs(pid: int) -> bool:
    """Not so a zombie that nobody waits for."""
    try:
        return bool(psutil.Process(pid).status() != psutil.STATUS_ZOMBIE)
    except psutil.NoSuchProcess:
        return False
