"""Who does not speak: when it is stepped all the same, and when it is offered the body that is told."""

from dataclasses import dataclass, replace

from mocapd.clock import nanoseconds
from mocapd.trackers.supervisor.params import Params


@dataclass(frozen=True, slots=True)
class Standby:
    """One tracker's, carried from frame to frame, while another speaks. next_ns: not stepped before, unless it may take
    over; astray_ns: since when it is lost or elsewhere, None when it is not; elsewhere_ns: since when it is live, but
    elsewhere, live_ns: when it last was; next_offer_ns: nothing is offered before."""

    next_ns: int = 0
    astray_ns: int | None = None
    elsewhere_ns: int | None = None
    live_ns: int = 0
    next_offer_ns: int = 0


def stepped(before: Standby, t_ns: int, params: Params) -> Standby:
    """After a step while another spoke."""
    return replace(before, next_ns=t_ns + nanoseconds(params.search_every_s))


def compared(before: Standby, t_ns: int, params: Params, *, live: bool, near: bool) -> Standby:
    """After a frame in which another spoke. live: it knows a body now; near: in the place of the one that is told."""
    if live and near:
        return replace(before, astray_ns=None, elsewhere_ns=None)
    astray_ns = t_ns if before.astray_ns is None else before.astray_ns
    elsewhere_ns, live_ns = before.elsewhere_ns, before.live_ns
    # an offer interrupts it for a few frames
    if elsewhere_ns is not None and t_ns - live_ns > nanoseconds(params.offer_after_s):
        elsewhere_ns = None
    if live:
        elsewhere_ns = t_ns if elsewhere_ns is None else elsewhere_ns
        live_ns = t_ns
    return replace(before, astray_ns=astray_ns, elsewhere_ns=elsewhere_ns, live_ns=live_ns)


def overrules(one: Standby, t_ns: int, params: Params) -> bool:
    """Whether it has been elsewhere for so long that it is right."""
    since_ns = one.elsewhere_ns
    return since_ns is not None and t_ns - since_ns >= nanoseconds(params.overrule_s)


def wants_offer(one: Standby, t_ns: int, params: Params) -> bool:
    """Whether it is to begin from the body that is told."""
    return (
        one.astray_ns is not None
        and t_ns - one.astray_ns >= nanoseconds(params.offer_after_s)
        and t_ns >= one.next_offer_ns
    )


def offered(before: Standby, t_ns: int, params: Params) -> Standby:
    """After it was offered that body."""
    return replace(before, next_ns=t_ns, next_offer_ns=t_ns + nanoseconds(params.offer_every_s))
