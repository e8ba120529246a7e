"""A body that was known a moment ago, to this tracker's predecessor: looked for where it was."""

from mocapd.body.model import BodyModel
from mocapd.body.skeleton import local_from_global
from mocapd.clock import nanoseconds
from mocapd.tracking.cues.clothes.clothes_cue import ClothesCue
from mocapd.tracking.cues.shirt.shirt_cue import ShirtCue
from mocapd.tracking.initialisers.base import Begun
from mocapd.tracking.track_state import Proportions, at_rest
from mocapd.types import BodyState, FrameSet, Skeleton


class GivenBody:
    """See Initialiser. Keeps the body until the next frame set."""

    name = "given_body"

    def __init__(
        self,
        model: BodyModel,
        skeleton: Skeleton,
        shirt: ShirtCue | None,
        clothes: ClothesCue | None,
        oldest_s: float,
    ) -> None:
        """model: of a whole body; oldest_s: a body that is older is not looked for."""
        self._model, self._skeleton = model, skeleton
        self._shirt, self._clothes = shirt, clothes
        self._oldest_ns = nanoseconds(oldest_s)
        self._body: BodyState | None = None

    def give(self, body: BodyState | None) -> None:
        """Look for this body in the next frame set; None: for nobody."""
        self._body = body if body is not None and body.pose is not None else None

    @property
    def body(self) -> BodyState | None:
        """Who is looked for."""
        return self._body

    def find(
        self, wearer: Proportions, present: dict[int, float], frames: FrameSet, turn: int, /
    ) -> Begun | None:
        """See Initialiser."""
        body, self._body = self._body, None
        if body is None or body.pose is None or abs(frames.t_ns - body.t_ns) > self._oldest_ns:
            return None
        local = local_from_global(self._skeleton, body.pose.quats_xyzw)
        there = at_rest(self._model, body.pose.root_m.copy(), local, wearer)
        trunk = whole = None
        if self._shirt is not None:
            trunk = self._shirt.begin(there, wearer.taught_s, present, turn)
        if self._clothes is not None:
            whole = self._clothes.begin(there, frames)
        return None if trunk is None and whole is None else Begun(there, trunk, whole)
