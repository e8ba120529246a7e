"""The pose of a person at a time that no frame is of yet: each bone turns on as it did, and keeps its length."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import msgspec

from mocapd.body.bones import NAMES, PARENT_OF
from mocapd.outputs import quaternions
from mocapd.outputs.prediction.trend import WINDOW_S, step_shares
from mocapd.outputs.wire import Joint, Quaternion, SkeletonFrame, Vector

MOST_AHEAD_S = 0.1  # farther than that nobody can tell [s]

_NS_PER_S = 1_000_000_000
_MOST_GAP_S = 0.25  # between frames; what was before a longer one says nothing of now [s]
_MOST_LAG_NS = 50_000_000  # that is believed, of smoothing
_MOST_FRAMES = 16  # that are remembered, however fast they come
_SURE = 0.3  # confidence from which a joint's motion is believed whole; below, less of it

_MOST_MOVE_M = 2.0  # from one frame to the next; who is farther away is another person, or nobody

_STILL: Vector = (0.0, 0.0, 0.0)
_KNOWN = frozenset(NAMES)


@dataclass(frozen=True, slots=True)
class _Step:
    """From a frame to the one after it. taken_s: how long it took; turns_rad: of each bone, about its parent's axes,
    the world's where its parent is not sent; moves_m: of those."""

    taken_s: float
    turns_rad: Mapping[str, Vector]
    moves_m: Mapping[str, Vector]


class PosePredictor:
    """Takes the frames of one person as they come, and tells the pose at any time after the newest. One thread at
    a time."""

    def __init__(self) -> None:
        self._newest: SkeletonFrame | None = None
        self._steps: list[_Step] = []  # newest first
        self._offsets_m: dict[str, Vector] | None = (
            None  # of the newest: bone by bone, in the parent's axes
        )

    def take(self, frame: SkeletonFrame) -> None:
        """Learn the newest frame. One that is no newer, of another daemon, or after a gap begins anew; so does `lost`."""
        before = self._newest
        self._newest, self._offsets_m = frame, None
        step = None if before is None else _step(before, frame)
        if step is None:
            self._steps = []
            return
        self._steps.insert(0, step)
        reach_s, kept = 0.0, 0
        for one in self._steps[:_MOST_FRAMES]:
            reach_s += one.taken_s
            if kept and reach_s > WINDOW_S:
                break
            kept += 1
        del self._steps[kept:]

    def at(self, unix_ns: int) -> SkeletonFrame | None:
        """The pose at this time [Unix, ns], by the sender's clock: a frame whose capture time is that, and `predicted_ns` how
        much of it lies ahead of the newest one's. None before the first frame.

        What smoothing has delayed is made up for. A time before the newest frame's gets that frame as it is, and so
        does every time while `lost`; one that is farther ahead than anybody can tell (MOST_AHEAD_S) gets the pose of
        that moment.
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
        shares = step_shares(ages_s, ahead_s)
        turns = [(share, step.turns_rad) for share, step in zip(shares, self._steps, strict=True)]
        moves = [(share, step.moves_m) for share, step in zip(shares, self._steps, strict=True)]
        if self._offsets_m is None:
            self._offsets_m = _offsets(newest.joints)
        found: dict[str, Joint] = {}
        for name in _parents_first(newest.joints):
            joint = newest.joints[name]
            x, y, z = _sum(name, turns)
            believed = min(1.0, max(0.0, joint.c / _SURE))
            turn = quaternions.exp((x * believed, y * believed, z * believed))
            parent = PARENT_OF.get(name)
            if parent is not None and parent in found:
                above = found[parent]
                local = quaternions.multiply(turn, joint.l)
                r = quaternions.multiply(above.r, local)
                start, (x, y, z) = above.p, quaternions.rotate(above.r, self._offsets_m[name])
            else:
                r = quaternions.multiply(turn, joint.r)
                local = r if parent is None else joint.l
                start, (x, y, z) = joint.p, _sum(name, moves)
            p = (start[0] + x, start[1] + y, start[2] + z)
            r, local = quaternions.canonical(r), quaternions.canonical(local)
            found[name] = Joint(p, r, local, joint.c, joint.u)
        return found


def _parents_first(joints: Mapping[str, Joint]) -> list[str]:
    """The names; those of bones that we do not know come last."""
    return [name for name in NAMES if name in joints] + [
        name for name in joints if name not in _KNOWN
    ]


def _step(before: SkeletonFrame, after: SkeletonFrame) -> _Step | None:
    """None where they do not follow each other."""
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


def _turn(then: Quaternion, now: Quaternion) -> Vector:
    x, y, z = quaternions.log(quaternions.multiply(now, quaternions.inverse(then)))
    return (x, y, z) if math.isfinite(x + y + z) else _STILL


def _move(then: Vector, now: Vector) -> Vector:
    x, y, z = now[0] - then[0], now[1] - then[1], now[2] - then[2]
    return (x, y, z) if abs(x) + abs(y) + abs(z) < _MOST_MOVE_M else _STILL


def _sum(name: str, shares: list[tuple[float, Mapping[str, Vector]]]) -> Vector:
    """What becomes of one bone: a step that has it not is one in which it stood still."""
    x = y = z = 0.0
    for share, of_bones in shares:
        step = of_bones.get(name)
        if step is not None:
            x, y, z = x + share * step[0], y + share * step[1], z + share * step[2]
    return x, y, z


def _offsets(joints: Mapping[str, Joint]) -> dict[str, Vector]:
    """Of each bone whose parent is sent: from the parent's joint to its own, in the axes that turn with the parent [m]."""
    found = {}
    for name, joint in joints.items():
        above = joints.get(PARENT_OF.get(name, ""))
        if above is not None:
            (x, y, z), (a, b, c) = joint.p, above.p
            found[name] = quaternions.rotate(quaternions.inverse(above.r), (x - a, y - b, z - c))
    return found
