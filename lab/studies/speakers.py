"""A recording of everything that goes wrong around somebody: who spoke when, and what a viewer saw of the changes."""

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
from mocapd.trackers.base import Track, unprobed
from mocapd.trackers.supervisor.supervisor import GLIDE
from mocapd.types import Floats

COASTS_S = 0.55  # a body may be told so long after somebody is gone, and a frame
_TRUNK = ("hips", "neck")  # somebody of whom a camera sees these is in view


@dataclass(frozen=True, slots=True, eq=False)
class Told:
    """What was told of each of F frame sets. times_s (F,): since the capture's start [s]; tracker (F,): who spoke, empty for
    nobody; gliding (F,): whether it was on the way from one speaker's body to the next one's; joints_m (F,J,3), NaN
    for nobody."""

    times_s: Floats
    tracker: NDArray[np.str_]
    gliding: NDArray[np.bool_]
    joints_m: Floats


@dataclass(frozen=True, slots=True)
class Switch:
    """at_s: the first time that `after` spoke [s]; frames: from the last one that `before` told to the first that is what
    `after` knows, 1 at best; step_cm: the farthest that a joint went in one of them beyond its true motion."""

    at_s: float
    before: str
    after: str
    frames: int
    step_cm: float


@dataclass(frozen=True, slots=True, eq=False)
class Interruptions:
    """One recording. in_view (F,): somebody is in the picture of a camera that delivers; step_cm (F,): the farthest that
    a joint went since the frame before beyond its true motion, NaN where there is nothing to compare; error_cm: of the
    joints, root mean square by speaker; ghosts: frames with a body when nobody has been there for a while."""

    name: str
    told: Told
    in_view: NDArray[np.bool_]
    step_cm: Floats
    switches: Sequence[Switch]
    error_cm: Mapping[str, float]
    ghosts: int

    @property
    def published(self) -> float:
        """Share of the frames with somebody in view that told a body."""
        return float((self.told.tracker[self.in_view] != "").mean())


def interruptions(case: Case, ready: ReadyTracker, progress: Progress) -> Interruptions:
    """Track a capture from its first frame to its last, and look at the changes; all joints that are scored."""
    told = _listened(case, ready, progress)
    truth, names = case.truth, list(case.truth.names)
    rows = np.abs(told.times_s[:, None] - truth.times_s[None, :]).argmin(axis=1)
    true_m, there = truth.joints_m[rows], truth.visible[rows]
    columns = [names.index(name) for name in JOINT_SETS["full"]]
    off_m = (told.joints_m - true_m)[:, columns]
    step_cm = np.full(len(rows), np.nan)
    step_cm[1:] = 100.0 * np.linalg.norm(np.diff(off_m, axis=0), axis=2).max(axis=1)
    in_view = there & _in_view(case, rows, true_m[:, [names.index(name) for name in _TRUNK]])
    squares = (off_m**2).sum(axis=2).mean(axis=1)
    return Interruptions(
        case.name,
        told,
        in_view,
        step_cm,
        switches(told, in_view, step_cm),
        {
            str(who): 100.0 * float(np.sqrt(np.nanmean(squares[told.tracker == who])))
            for who in dict.fromkeys(told.tracker[(told.tracker != "") & there])
        },
        _ghosts(told, there),
    )


def switches(told: Told, in_view: NDArray[np.bool_], step_cm: Floats) -> tuple[Switch, ...]:
    """Every change of the speaker while somebody was in view all the time."""
    out = []
    spoken = np.flatnonzero(told.tracker != "")
    runs = [list(run) for _, run in groupby(spoken, key=lambda k: str(told.tracker[k]))]
    for before, after in pairwise(runs):
        last, first = before[-1], after[0]
        if not in_view[last : first + 1].all():
            continue  # somebody left, and who came was found anew
        arrived = next((k for k in after if not told.gliding[k]), after[-1])
        steps = step_cm[last + 1 : arrived + 1]
        farthest = float(np.nanmax(steps)) if np.isfinite(steps).any() else float("nan")
        names = str(told.tracker[last]), str(told.tracker[first])
        out.append(Switch(float(told.times_s[first]), *names, int(arrived - last), farthest))
    return tuple(out)


def _listened(case: Case, ready: ReadyTracker, progress: Progress) -> Told:
    heard: list[str] = []
    tracker, shape = ready.tracker, ready.shape
    tracker.probe = heard.append
    tracks: list[Track] = []
    gliding = []
    for done, frames in enumerate(frame_sets(case.folder), start=1):
        heard.clear()
        tracks.append(tracker.step(frames, shape))
        shape = tracks[-1].shape
        gliding.append(GLIDE in heard)
        progress(f"tracking {case.name}", done, case.frames)
    tracker.probe = unprobed
    nobody = np.full((len(case.truth.names), 3), np.nan)
    bodies = [track.body for track in tracks]
    return Told(
        np.array([seconds(body.t_ns) for body in bodies]),
        np.array(["" if body.pose is None else body.tracker for body in bodies], dtype=np.str_),
        np.array(gliding),
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


def _ghosts(told: Told, there: NDArray[np.bool_]) -> int:
    """Frames with a body longer after somebody was there than one may coast."""
    last_s = np.maximum.accumulate(np.where(there, told.times_s, -np.inf))
    return int(((told.tracker != "") & (told.times_s - last_s > COASTS_S)).sum())
