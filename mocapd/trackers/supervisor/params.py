"""The numbers of the supervisor's decisions, with units and reasons."""

from dataclasses import dataclass, field

from mocapd.trackers.steadying import Following, SteadyingParams


@dataclass(frozen=True, slots=True)
class Params:
    """Times are of the frames, never counted in them."""

    # belief
    # good for so long before it may take over: one sleeve is free before the other
    confirm_s: float = 0.5
    # poor or coasting for so long before another may: a frame that fails is no reason
    doubt_s: float = 0.1

    # live for so long before it begins to speak where nobody was, or known before it completes who speaks: the first
    # looks at who walks in are the worst
    arrive_s: float = 0.15

    # one place
    # trunks nearer than this are of one body: cloth, shape and lag together stay below it
    near_m: float = 0.3
    # somewhere else for so long, and the tracker that is preferred is right: it was offered the other's body meanwhile
    overrule_s: float = 2.0

    # who does not speak
    # a search costs three frames' time: a tenth of it is spared for that
    search_every_s: float = 0.2
    # lost or elsewhere for so long, and it is offered the body that is told
    offer_after_s: float = 0.5
    offer_every_s: float = 2.0  # it forgets background and light by that

    # what remains at a switch is mended within glide_s, of any joint at glide_m_s at least, at any frame rate, and never
    # by more than glide_m in a frame: a tenth of a metre is promised
    glide_s: float = 0.25
    glide_m_s: float = 1.5
    glide_m: float = 0.09
    # who settles on the way goes faster than that, as hands do in a throw; or this much otherwise than a frame ago
    jump_m_s: float = 3.0
    jump_m: float = 0.05
    glide_within_s: float = 0.5  # after a longer gap nothing is left to glide from

    # arms that hardly a picture confirms, of who knows the upper body alone: more mildly than without the shirt, whose
    # colours mistake arms less
    steadying: SteadyingParams = field(
        default_factory=lambda: SteadyingParams(trust_s=0.7, sure_rad_s=60.0, glide=0.0).with_all(
            Following(sure=0.6, doubtful=0.0, least=0.4, doubtful_rad_s=15.0)
        )
    )
