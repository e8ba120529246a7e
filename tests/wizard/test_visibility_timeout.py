"""Looks in vain end a step; a slow machine does not."""

from mocapd.wizard.body.body_measuring import VisibilityTimeout


def looks_until_ended(took_s: float) -> int:
    timeout, looks = VisibilityTimeout(4.0), 0
    while not timeout.is_over:
        timeout.update(took_s, visible=False)
        looks += 1
    return looks


def test_it_ends_after_looks_in_vain() -> None:
    assert looks_until_ended(0.125) == 32


def test_on_a_slow_machine_a_wearer_gets_as_many_looks() -> None:
    assert looks_until_ended(0.25) == looks_until_ended(5.0) == 16


def test_what_is_seen_costs_nothing() -> None:
    timeout = VisibilityTimeout(0.1)
    for _ in range(1000):
        timeout.update(1.0, visible=True)
    assert not timeout.is_over
