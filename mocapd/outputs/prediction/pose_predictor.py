"""Extrapolates the pose of a person beyond the newest frame: each bone continues its rotation and keeps its length."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import msgspec

from mocapd.body.bones import NAMES, PARENT_OF
from mocapd.outputs import quaternions
from mocapd.outputs.prediction.extrapolation_weights import WINDOW_S, step_weights
from mocapd.outputs.wire import Joint, Quaternion, SkeletonFrame, Vector

MOST_AHEAD_S = 0.1  # longest extrapolation [s]

_NS_PER_S = 1_000_000_000
_MOST_GAP_S = 0.25  # between frames; a longer gap clears the history [s]
_LEAST_GAP_S = 1e-3  # a frame that follows sooner is of the same instant: no motion between [s]
_MOST_LAG_NS = 50_000_000  # largest smoothing lag that is compensated
_MOST_FRAMES = 16  # of the history, at any frame rate
_SURE = 0.3  # confidence from which a joint's motion counts fully; below, in proportion

_MOST_MOVE_M = 2.0  # between two frames; a longer one is another person or an error

_STILL: Vector = (0.0, 0.0, 0.0)
_OUR_BONES = frozenset(NAMES)


@dataclass(frozen=True, slots=True)
class _Step:
    """The motion between two frames. taken_s: their interval; turns_rad: rotation vector of each bone in its parent's
    axes, or the world's where its parent is not sent; moves_m: translation of the bones without parent."""

    taken_s: float
    turns_rad: Mapping[str, Vector]
    moves_m: Mapping[str, Vector]


class PosePredictor:
    """History of one person's frames, and the pose at any time after the newest. One thread at a time."""

    def __init__(self) -> None:
        self._newest: SkeletonFrame | None = None
        self._steps: list[_Step] = []  # newest first
        self._is_held = False  # the newest frame repeats the pose before it, as no camera delivered
        # of the newest frame: of each bone, in the parent's axes
        self._offsets_m: dict[str, Vector] | None = None

    def take(self, frame: SkeletonFrame) -> None:
        """Add the newest frame. A frame that is not newer, of another daemon, `lost`, after a gap or after a held pose
        clears the history; one of the same instant replaces the last."""
        before, was_held = self._newest, self._is_held
        self._newest, self._offsets_m = frame, None
        self._is_held = before is not None and _is_held(before, frame)
        step = None if before is None else _step(before, frame)
        if step is None or was_held:
            self._steps = []
            return
        if step.taken_s < _LEAST_GAP_S:
            return
        self._steps.insert(0, step)
        window_s, count = 0.0, 0
        for step in self._steps[:_MOST_FRAMES]:
            window_s += step.taken_s
            if count and window_s > WINDOW_S:
                break
            count += 1
        del self._steps[count:]

    def at(self, unix_ns: int) -> SkeletonFrame | None:
        """The frame with the pose at this time [Unix, ns, the sender's clock]; None before the first frame.

        Its capture time is `unix_ns`, its `predicted_ns` the time since the newest frame. The smoothing lag is
        compensated. Returns the newest frame unchanged for an earlier time and while `lost`. Extrapolates by
        MOST_AHEAD_S at most.
        """
        newest = self._newest
        if newest is None or not newest.joints:
            return newest
        ahead_ns = min(unix_ns - newest.capture_unix_ns, round(MOST_AHEAD_S * _NS_PER_S))
        if ahead_ns < 0:
            return newest
        lag_ns = min(max(0, newest.smoothing_lag_ns), _MOST_LAG_NS)
        return msgspec.structs.replace(
            newest,
            capture_unix_ns=newest.capture_unix_ns + ahead_ns,
            capture_monotonic_ns=newest.capture_monotonic_ns + ahead_ns,
            predicted_ns=newest.predicted_ns + ahead_ns,
            joints=self._joints(newest, (ahead_ns + lag_ns) / _NS_PER_S),
            smoothing_lag_ns=newest.smoothing_lag_ns - lag_ns,
        )

    def _joints(self, newest: SkeletonFrame, ahead_s: float) -> dict[str, Joint]:
        ages_s = [0.0]
        for step in self._steps:
            ages_s.append(ages_s[-1] + step.taken_s)
        shares = step_weights(ages_s, ahead_s)
        turns = [(share, step.turns_rad) for share, step in zip(shares, self._steps, strict=True)]
        moves = [(share, step.moves_m) for share, step in zip(shares, self._steps, strict=True)]
        if self._offsets_m is None:
            self._offsets_m = _offsets(newest.joints)
        predicted: dict[str, Joint] = {}
        for name in _parents_first(newest.joints):
            joint = newest.joints[name]
            x, y, z = _sum(name, turns)
            gain = min(1.0, max(0.0, joint.c / _SURE))
            turn = quaternions.exp((x * gain, y * gain, z * gain))
            parent = PARENT_OF.get(name)
            if parent is not None and parent in predicted:
                above = predicted[parent]
                local = quaternions.multiply(turn, joint.l)
                r = quaternions.multiply(above.r, local)
                start, (x, y, z) = above.p, quaternions.rotate(above.r, self._offsets_m[name])
            else:
                r = quaternions.multiply(turn, joint.r)
                local = r if parent is None else joint.l
                start, (x, y, z) = joint.p, _sum(name, moves)
            p = (start[0] + x, start[1] + y, start[2] + z)
            r, local = quaternions.canonical(r), quaternions.canonical(local)
            predicted[name] = Joint(p, r, local, joint.c, joint.u)
        return predicted


def _parents_first(joints: Mapping[str, Joint]) -> list[str]:
    """The names, parents first; names that are not in our skeleton come last."""
    return [name for name in NAMES if name in joints] + [
        name for name in joints if name not in _OUR_BONES
    ]


def _step(before: SkeletonFrame, after: SkeletonFrame) -> _Step | None:
    """None where the frames are not consecutive frames of one person."""
    taken_s = (after.capture_unix_ns - before.capture_unix_ns) / _NS_PER_S
    if not 0.0 < taken_s <= _MOST_GAP_S or not (before.joints and after.joints):
        return None
    if (before.instance, before.person) != (after.instance, after.person):
        return None
    turns_rad: dict[str, Vector] = {}
    moves_m: dict[str, Vector] = {}
    for name, now in after.joints.items():
        then = before.joints.get(name)
        if then is None:
            continue
        if PARENT_OF.get(name) in after.joints:
            turns_rad[name] = _turn(then.l, now.l)
        else:
            turns_rad[name] = _turn(then.r, now.r)
            moves_m[name] = _move(then.p, now.p)
    return _Step(taken_s, turns_rad, moves_m)


def _is_held(before: SkeletonFrame, after: SkeletonFrame) -> bool:
    """True if a coasting frame has the pose before it: what a person does meanwhile is in the next frame, all at once."""
    return after.tracking == "coasting" and all(
        name in before.joints and (before.joints[name].p, before.joints[name].r) == (now.p, now.r)
        for name, now in after.joints.items()
    )


def _turn(then: Quaternion, now: Quaternion) -> Vector:
    x, y, z = quaternions.log(quaternions.multiply(now, quaternions.inverse(then)))
    return (x, y, z) if math.isfinite(x + y + z) else _STILL


def _move(then: Vector, now: Vector) -> Vector:
    x, y, z = now[0] - then[0], now[1] - then[1], now[2] - then[2]
    return (x, y, z) if abs(x) + abs(y) + abs(z) < _MOST_MOVE_M else _STILL


def _sum(name: str, shares: list[tuple[float, Mapping[str, Vector]]]) -> Vector:
    """Weighted sum of one bone's steps; a step without the bone counts as zero."""
    x = y = z = 0.0
    for share, of_bones in shares:
        step = of_bones.get(name)
        if step is not None:
            x, y, z = x + share * step[0], y + share * step[1], z + share * step[2]
    return x, y, z


def _offsets(joints: Mapping[str, Joint]) -> dict[str, Vector]:
    """Offset from the parent's joint in the parent's axes [m], for each bone whose parent is sent."""
    offsets_m = {}
    for name, joint in joints.items():
        above = joints.get(PARENT_OF.get(name, ""))
        if above is not None:
            (x, y, z), (a, b, c) = joint.p, above.p
            offset = (x - a, y - b, z - c)
            offsets_m[name] = quaternions.rotate(quaternions.inverse(above.r), offset)
    return offsets_m
