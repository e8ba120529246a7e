"""Who leads when several windows are open."""

from mocapd.web.seat import GRACE_S, Seat


def test_the_first_leads_and_its_place_is_kept_for_a_moment() -> None:
    seat, one, other, again = Seat(), object(), object(), object()
    seat.join(one)
    seat.join(other)
    assert seat.drives(one, 0.0)
    assert not seat.drives(other, 0.0)
    seat.leave(one, 10.0)  # its page is loaded anew
    assert not seat.drives(other, 10.0 + GRACE_S / 2)
    seat.join(again)
    assert seat.drives(again, 10.0 + GRACE_S / 2)
    assert not seat.drives(other, 10.0 + 2 * GRACE_S)


def test_after_that_moment_the_one_that_waits_longest_leads() -> None:
    seat, links = Seat(), [object() for _ in range(3)]
    for link in links:
        seat.join(link)
    seat.leave(links[0], 10.0)
    assert not seat.drives(links[2], 10.0 + 2 * GRACE_S)
    assert seat.drives(links[1], 10.0 + 2 * GRACE_S)


def test_taking_over_and_leaving_while_looking_on() -> None:
    seat, one, other = Seat(), object(), object()
    seat.join(one)
    seat.join(other)
    seat.take_over(other)
    assert not seat.drives(one, 0.0)
    seat.leave(one, 0.0)
    assert seat.drives(other, 0.0)
