"""A recording of everything that goes wrong around somebody: which cues carried the body when, and how far joints stepped."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby, pairwise

import numpy as np
from numpy.typing import NDArray

from mocapd.capture.capture_folder import frame_sets
from mocapd.clock import seconds
from mocapd.evaluate.capture_eval import Case
from mocapd.evaluate.score import JOINT_SETS
from mocapd.geometry.camera_model import project
from mocapd.session.tracker_setup import Progress, ReadyTracker
from mocapd.tracking.base import Track
from mocapd.tracking.pose_filter import PoseFilterParams
from mocapd.types import Floats

COASTS_S = 0.55  # a body may be published so long after somebody is gone, and a frame
APPROACH_S = PoseFilterParams().approach_s  # after a change of cues
_TRUNK = ("hips", "neck")  # somebody of whom a camera sees these is in view


@dataclass(frozen=True, slots=True, eq=False)
class PublishedBodies:
    """What was published of each of F frame sets. times_s (F,): since the capture's start [s]; carrier (F,): the cues that
    carried the body, empty for nobody; joints_m (F,J,3), NaN for nobody."""

    times_s: Floats
    carrier: NDArray[np.str_]
    joints_m: Floats


@dataclass(frozen=True, slots=True)
class CueChange:
    """at_s: the first time that `after` carried the body [s]; step_cm: the farthest that a joint went in a frame beyond its
    true motion, from the last frame of `before` until the pose filter has approached what `after` found."""

    at_s: float
    before: str
    after: str
    step_cm: float


@dataclass(frozen=True, slots=True, eq=False)
class Interruptions:
    """One recording. in_view (F,): somebody is in the picture of a camera that delivers; step_cm (F,): the farthest that
    a joint went since the frame before beyond its true motion, NaN where there is nothing to compare; error_cm: of the
    joints, root mean square by the cues; ghosts: frames with a body when nobody has been there for a while."""

    name: str
    bodies: PublishedBodies
    in_view: NDArray[np.bool_]
    step_cm: Floats
    changes: Sequence[CueChange]
    error_cm: Mapping[str, float]
    ghosts: int

    @property
    def published(self) -> float:
        """Share of the frames with somebody in view that have a body."""
        return float((self.bodies.carrier[self.in_view] != "").mean())


def interruptions(case: Case, ready: ReadyTracker, progress: Progress) -> Interruptions:
    """Track a capture from its first frame to its last, and look at the changes; all joints that are scored."""
    bodies = _published(case, ready, progress)
    truth, names = case.truth, list(case.truth.names)
    rows = np.abs(bodies.times_s[:, None] - truth.times_s[None, :]).argmin(axis=1)
    true_m, there = truth.joints_m[rows], truth.visible[rows]
    columns = [names.index(name) for name in JOINT_SETS["full"]]
    off_m = (bodies.joints_m - true_m)[:, columns]
    step_cm = np.full(len(rows), np.nan)
    step_cm[1:] = 100.0 * np.linalg.norm(np.diff(off_m, axis=0), axis=2).max(axis=1)
    in_view = there & _in_view(case, rows, true_m[:, [names.index(name) for name in _TRUNK]])
    squares = (off_m**2).sum(axis=2).mean(axis=1)
    return Interruptions(
        case.name,
        bodies,
        in_view,
        step_cm,
        cue_changes(bodies, in_view, step_cm),
        {
            str(cues): 100.0 * float(np.sqrt(np.nanmean(squares[bodies.carrier == cues])))
            for cues in dict.fromkeys(bodies.carrier[(bodies.carrier != "") & there])
        },
        _ghosts(bodies, there),
    )


def cue_changes(
    bodies: PublishedBodies, in_view: NDArray[np.bool_], step_cm: Floats
) -> tuple[CueChange, ...]:
    """Every change of the cues while somebody was in view all the time."""
    out = []
    with_body = np.flatnonzero(bodies.carrier != "")
    runs = [list(run) for _, run in groupby(with_body, key=lambda k: str(bodies.carrier[k]))]
    for before, after in pairwise(runs):
        last, first = before[-1], after[0]
        if not in_view[last : first + 1].all():
            continue  # somebody left, and who came was found anew
        at_s = float(bodies.times_s[first])
        within = [k for k in after if bodies.times_s[k] <= at_s + APPROACH_S]
        steps = step_cm[last + 1 : within[-1] + 1]
        farthest = float(np.nanmax(steps)) if np.isfinite(steps).any() else float("nan")
        names = str(bodies.carrier[last]), str(bodies.carrier[first])
        out.append(CueChange(at_s, *names, farthest))
    return tuple(out)


def _published(case: Case, ready: ReadyTracker, progress: Progress) -> PublishedBodies:
    tracker, shape = ready.tracker, ready.shape
    tracks: list[Track] = []
    for done, frames in enumerate(frame_sets(case.folder), start=1):
        tracks.append(tracker.step(frames, shape))
        shape = tracks[-1].shape
        progress(f"tracking {case.name}", done, case.frames)
    nobody = np.full((len(case.truth.names), 3), np.nan)
    bodies = [track.body for track in tracks]
    return PublishedBodies(
        np.array([seconds(body.t_ns) for body in bodies]),
        np.array(["" if body.pose is None else body.tracker for body in bodies], dtype=np.str_),
        np.array([nobody if body.joints_m is None else body.joints_m for body in bodies]),
    )


def _in_view(case: Case, rows: NDArray[np.intp], points_m: Floats) -> NDArray[np.bool_]:
    """(F,): whether all points (F,N,3) are in the picture of one camera that delivers it."""
    out = np.zeros(len(rows), dtype=bool)
    for camera, recorded in zip(case.folder.rig.cameras, case.folder.cameras, strict=True):
        px = project(camera, points_m)  # NaN behind it, which is nowhere in the picture
        inside = ((px > 0.0) & (px < np.array(camera.size_px))).all(axis=(1, 2))
        out |= inside & np.array([recorded.has(int(row)) for row in rows])
    return out


def _ghosts(bodies: PublishedBodies, there: NDArray[np.bool_]) -> int:
    """Frames with a body longer after somebody was there than one may coast."""
    last_s = np.maximum.accumulate(np.where(there, bodies.times_s, -np.inf))
    return int(((bodies.carrier != "") & (bodies.times_s - last_s > COASTS_S)).sum())
