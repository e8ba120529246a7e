"""Initialisers: ways to start a track without a previous pose, by the shirt, the clothes or another tracker's body."""

from dataclasses import dataclass
from typing import Protocol

from mocapd.body.model import BodyModel
from mocapd.body.skeleton import local_from_global
from mocapd.clock import nanoseconds
from mocapd.fit.motion_state import MotionState
from mocapd.tracking.cues.clothes.clothes_cue import ClothesCue
from mocapd.tracking.cues.clothes.clothes_solver import ClothesEstimate
from mocapd.tracking.cues.clothes.first_legs import LEGS
from mocapd.tracking.cues.shirt.shirt_cue import ShirtCue, ShirtEstimate
from mocapd.tracking.cues.shirt.shirt_locator import ShirtLocator
from mocapd.tracking.track_state import BodyShapeEstimate, resting_state
from mocapd.types import BodyState, FrameSet, Skeleton


@dataclass(frozen=True, slots=True, eq=False)
class InitialPose:
    """A whole body to start a track, with each cue's estimate."""

    body: MotionState
    trunk: ShirtEstimate | None = None
    whole: ClothesEstimate | None = None


class Initialiser(Protocol):
    """Runs in each frame set while no person is tracked; may keep state between calls."""

    name: str

    def find(
        self,
        wearer: BodyShapeEstimate,
        present: dict[int, float],
        frames: FrameSet,
        frame_index: int,
        /,
    ) -> InitialPose | None:
        """A person in this frame set. present: each present camera's time offset [s], by index; frame_index: see `Ticks`."""
        ...


class ShirtPose:
    """Searches all pictures for the shirt's patches, which the pose database knows; see Initialiser."""

    name = "shirt_pose"

    def __init__(self, locator: ShirtLocator) -> None:
        self._locator = locator

    def find(
        self,
        wearer: BodyShapeEstimate,
        present: dict[int, float],
        frames: FrameSet,
        frame_index: int,
        /,
    ) -> InitialPose | None:
        """See Initialiser."""
        trunk = self._locator.search(wearer, present, frames.t_ns, frame_index)
        return (
            None if trunk is None else InitialPose(self._locator.upright_body(trunk, wearer), trunk)
        )


class ForegroundPerson:
    """A person in any clothes in the foreground, upright, sitting or crouching: `person_search`; see Initialiser."""

    name = "person_before_background"

    def __init__(self, clothes: ClothesCue) -> None:
        self._clothes = clothes

    def find(
        self,
        wearer: BodyShapeEstimate,
        _present: dict[int, float],
        frames: FrameSet,
        _frame_index: int,
        /,
    ) -> InitialPose | None:
        """See Initialiser."""
        whole = self._clothes.search(wearer, frames.t_ns)
        return None if whole is None else InitialPose(whole.motion, None, whole)


class HandedOverBody:
    """A recent body of another tracker, at its place; see Initialiser. Keeps the body until the next frame set."""

    name = "given_body"

    def __init__(
        self,
        model: BodyModel,
        skeleton: Skeleton,
        shirt: ShirtCue | None,
        clothes: ClothesCue | None,
        max_age_s: float,
    ) -> None:
        """model: of a whole body; max_age_s: a body that is older is not looked for."""
        self._model, self._skeleton = model, skeleton
        self._shirt, self._clothes = shirt, clothes
        self._max_age_ns = nanoseconds(max_age_s)
        self._body: BodyState | None = None

    def set_body(self, body: BodyState | None) -> None:
        """Sets the body for the next frame set; None: none."""
        self._body = body if body is not None and body.pose is not None else None

    @property
    def body(self) -> BodyState | None:
        """The body to start from."""
        return self._body

    def find(
        self,
        wearer: BodyShapeEstimate,
        present: dict[int, float],
        frames: FrameSet,
        frame_index: int,
        /,
    ) -> InitialPose | None:
        """See Initialiser."""
        body, self._body = self._body, None
        if body is None or body.pose is None or abs(frames.t_ns - body.t_ns) > self._max_age_ns:
            return None
        local = local_from_global(self._skeleton, body.pose.quats_xyzw)
        start = resting_state(self._model, body.pose.root_m.copy(), local, wearer)
        trunk = whole = None
        if self._shirt is not None:
            trunk = self._shirt.start_from(start, wearer.taught_s, present, frame_index)
        # legs that nobody saw teach no look: below the shirt they are found as anybody's first ones
        saw_legs = bool(body.confidence[LEGS].any())
        if self._clothes is not None and (saw_legs if trunk is not None else self._clothes.alone):
            whole = self._clothes.start_from(start)
        return None if trunk is None and whole is None else InitialPose(start, trunk, whole)
