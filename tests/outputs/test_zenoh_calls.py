"""What was opened in Zenoh is let go of within a call alone, or by the main thread at the end."""

import weakref
from typing import cast

import zenoh

from mocapd.bus.zenoh_calls import hold_session, zenoh_call


class Session:
    """Open until it is told otherwise."""

    def __init__(self) -> None:
        self.is_open = True
        self.is_closing = False

    def is_closed(self) -> bool:
        if self.is_closing:
            raise RuntimeError("Already mutably borrowed")
        return not self.is_open

    def __enter__(self) -> "Session":
        return self

    def __exit__(self, *_: object) -> None:
        self.is_open = False


class Thing:
    """A subscriber, or the client that has it."""


def held(session: Session, owner: Thing | None = None) -> "weakref.ref[Thing]":
    subscriber = Thing()
    with zenoh_call():
        hold_session(cast("zenoh.Session", session), subscriber, owner=owner)
    return weakref.ref(subscriber)


def test_it_outlives_who_opened_it_and_ends_in_a_later_call() -> None:
    session = Session()
    subscriber = held(session)
    session.is_open = False
    assert subscriber() is not None
    with Session() as later:
        held(later)
        assert subscriber() is None


def test_it_is_held_while_the_session_is_open_or_its_owner_lives() -> None:
    session, owner = Session(), Thing()
    subscriber = held(session, owner)
    with Session() as later:
        held(later)
        assert subscriber() is not None
        session.is_open = False
        held(later)
        assert subscriber() is not None
        del owner
        held(later)
        assert subscriber() is None


def test_it_is_held_while_another_thread_closes_its_session() -> None:
    session = Session()
    subscriber = held(session)
    session.is_closing = True  # as Zenoh answers who asks meanwhile
    with Session() as later:
        held(later)
        assert subscriber() is not None
        session.is_closing, session.is_open = False, False
        held(later)
        assert subscriber() is None
