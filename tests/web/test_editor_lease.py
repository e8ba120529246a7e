"""Who leads when several windows are open."""

from mocapd.web.editor_lease import GRACE_S, EditorLease


def test_the_first_leads_and_its_place_is_kept_for_a_moment() -> None:
    lease, one, other, again = EditorLease(), object(), object(), object()
    lease.join(one)
    lease.join(other)
    assert lease.drives(one, 0.0)
    assert not lease.drives(other, 0.0)
    lease.leave(one, 10.0)  # its page is loaded anew
    assert not lease.drives(other, 10.0 + GRACE_S / 2)
    lease.join(again)
    assert lease.drives(again, 10.0 + GRACE_S / 2)
    assert not lease.drives(other, 10.0 + 2 * GRACE_S)


def test_after_that_moment_the_one_that_waits_longest_leads() -> None:
    lease, links = EditorLease(), [object() for _ in range(3)]
    for link in links:
        lease.join(link)
    lease.leave(links[0], 10.0)
    assert not lease.drives(links[2], 10.0 + 2 * GRACE_S)
    assert lease.drives(links[1], 10.0 + 2 * GRACE_S)


def test_taking_over_and_leaving_while_looking_on() -> None:
    lease, one, other = EditorLease(), object(), object()
    lease.join(one)
    lease.join(other)
    lease.take_over(other)
    assert not lease.drives(one, 0.0)
    lease.leave(one, 0.0)
    assert lease.drives(other, 0.0)
