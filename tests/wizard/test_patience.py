"""Looks in vain end a step; a slow machine does not."""

from mocapd.wizard.patience import Patience


def looks_until_ended(took_s: float) -> int:
    patience, looks = Patience(4.0), 0
    while not patience.ended:
        patience.looked(took_s, seen=False)
        looks += 1
    return looks


def test_it_ends_after_looks_in_vain() -> None:
    assert looks_until_ended(0.125) == 32


def test_on_a_slow_machine_a_wearer_gets_as_many_looks() -> None:
    assert looks_until_ended(0.25) == looks_until_ended(5.0) == 16


def test_what_is_seen_costs_nothing() -> None:
    patience = Patience(0.1)
    for _ in range(1000):
        patience.looked(1.0, seen=True)
    assert not patience.ended
