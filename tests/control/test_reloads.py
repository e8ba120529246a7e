"""Who asks for the configuration to be read again hears what became of just that."""

import threading
from concurrent.futures import Future, ThreadPoolExecutor

import pytest

from mocapd.control.control_messages import Reloaded
from mocapd.control.reloads import Reloads
from mocapd.errors import ConfigError, UnavailableError
from tests.outputs.frames import eventually

DONE, LATER = Reloaded(0.1, ()), Reloaded(0.2, ("web",))


def test_who_asks_during_a_reading_waits_for_the_next() -> None:
    reloads = Reloads()
    assert not reloads.take()
    with ThreadPoolExecutor(2) as pool:
        first = pool.submit(reloads.ask)
        assert eventually(reloads.take)
        second = _asking(pool, reloads)
        reloads.settle(DONE)
        assert first.result(60.0) == DONE
        assert not second.done()
        assert reloads.take()
        reloads.settle(LATER)
        assert second.result(60.0) == LATER
    assert not reloads.take()


def test_a_refusal_is_raised_where_it_was_asked_and_the_end_is_one() -> None:
    reloads = Reloads()
    with ThreadPoolExecutor(1) as pool:
        asked = pool.submit(reloads.ask)
        assert eventually(reloads.take)
        reloads.settle(ConfigError("no", "key"))
        with pytest.raises(ConfigError, match="key: no"):
            asked.result(60.0)
        asked = _asking(pool, reloads)
        reloads.close()
        with pytest.raises(UnavailableError, match="it is ending"):
            asked.result(60.0)
    with pytest.raises(UnavailableError, match="it is ending"):
        reloads.ask()


def _asking(pool: ThreadPoolExecutor, reloads: Reloads) -> "Future[Reloaded]":
    """One that certainly waits by now."""
    begun = threading.Event()

    def ask() -> Reloaded:
        begun.set()
        return reloads.ask()

    asked = pool.submit(ask)
    assert begun.wait(60.0)
    assert not eventually(asked.done, within_s=0.1)
    return asked
