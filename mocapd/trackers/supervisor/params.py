"""The numbers of the supervisor's decisions, with units and reasons."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Params:
    """Times are of the frames, never counted in them."""

    # belief
    confirm_s: float = (
        0.5  # good for so long before it may take over: one sleeve is free before the other
    )
    doubt_s: float = (
        0.1  # poor or coasting for so long before another may: a frame that fails is no reason
    )

    # one place
    near_m: float = (
        0.3  # trunks nearer than this are of one body: cloth, shape and lag together stay below it
    )
    # somewhere else for so long, and the tracker that is preferred is right: it was offered the other's body meanwhile
    overrule_s: float = 2.0

    # who does not speak
    search_every_s: float = (
        0.2  # a search costs three frames' time: a tenth of it is spared for that
    )
    offer_after_s: float = (
        0.5  # lost or elsewhere for so long, and it is offered the body that is told
    )
    offer_every_s: float = 2.0  # it forgets background and light by that

    # what remains at a switch is mended within glide_s, of any joint at glide_m_s at least, at any frame rate, and never
    # by more than glide_m in a frame: a tenth of a metre is promised
    glide_s: float = 0.3
    glide_m_s: float = 1.5
    glide_m: float = 0.09
    jump_m_s: float = 3.0  # who settles after a switch goes faster than that; hands do in a throw
    glide_within_s: float = 0.5  # after a longer gap nothing is left to glide from
