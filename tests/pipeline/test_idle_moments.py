"""Work that can wait for the pipeline's idle moments, and goes on without them."""

import threading

from mocapd.pipeline.idle_moments import IdleMoments

LONG_S = 60.0


def test_who_waits_goes_on_at_the_next_moment() -> None:
    idle, over = IdleMoments(), threading.Event()

    def work() -> None:
        idle.wait(LONG_S)
        over.set()

    threading.Thread(target=work, daemon=True).start()
    while not over.wait(0.01):
        idle.begin()  # it may not wait yet


def test_without_such_a_moment_nobody_waits_for_ever() -> None:
    IdleMoments().wait(0.01)
