"""Facts of a first start's preparation."""

import fcntl
import os
from contextlib import suppress

from mocapd.config.sections import Config
from mocapd.doctor.facts import PreparationFacts
from mocapd.session.prepared_marker import LOCK, is_prepared


def preparation_facts(config: Config) -> PreparationFacts:
    """The facts, from the marker and the state of the lock."""
    return PreparationFacts(is_prepared(config), _is_held(config))


def _is_held(config: Config) -> bool:
    with suppress(OSError):
        lock = os.open(
            config.cache_dir / LOCK, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC
        )
        try:
            fcntl.flock(lock, fcntl.LOCK_SH | fcntl.LOCK_NB)
        except BlockingIOError:
            return True
        finally:
            os.close(lock)
    return False
