"""Whether people are found who sit, kneel, squat, crouch, lie, or show the back from the start; without the shirt.

    python -m tests.tracking.stances_study FOLDER [--tracker markerless] [--only NAME ...]

records ten simulated sessions into FOLDER, where they stay for the next run, tracks each and prints a table. A session
passes when somebody is tracked in 80 % of the frames that begin 2 s after they appear, with a mean error of all joints of at
most 20 cm and no frame of a ghost; what is not found must have a reason. Where only things are moved nobody must be found.
"""

import argparse
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mocapd.calibration.from_origin import from_origin
from mocapd.capture.kinds.source_kinds import open_origin
from mocapd.evaluate.score import JOINT_SETS
from mocapd.evaluate.tables import number, table
from mocapd.evaluate.truth import load_truth
from mocapd.session.offline import track_all
from mocapd.session.tracker_setup import ready_tracker
from mocapd.trackers.registry import Resources
from mocapd.tracking.base import LostReason
from tests.tracking.stances.moved_things import THINGS, MovedThing, filmed
from tests.tracking.stances.sessions import SESSIONS, record

SETTLED_S = 2.0  # after somebody appears
LEAST_FOUND, MOST_CM = 0.8, 20.0
_NEEDED = 8
_HEADS = (
    "session", "rig", "found after [s]", "frames after 2 s", "mean error [cm]", "ghosts", "passes", "reason",
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class Outcome:
    """first_s: from when somebody appears to the first frame with a body, inf for never; found: share of the frames after
    SETTLED_S with one; mean_cm: of the joints' errors in those; ghosts: frames with a body before anybody is there; reason:
    why nobody is tracked, where that is told in some frame."""

    name: str
    first_s: float
    found: float
    mean_cm: float
    ghosts: int
    reason: str

    @property
    def passes(self) -> bool:
        return self.found >= LEAST_FOUND and self.mean_cm <= MOST_CM and self.ghosts == 0


def outcome(folder: Path, tracker: str) -> Outcome:
    """Track a recorded session, and compare it with its truth."""
    truth = load_truth(folder)
    origin = open_origin(str(folder), folder.parent, lambda *_: None)
    ready = ready_tracker(tracker, from_origin(origin), Resources(cache_dir=folder.parent))
    result = track_all(ready.tracker, ready.shape, origin.frame_sets(), lambda _: None)
    appears_s = float(truth.times_s[truth.visible][0])
    joints = JOINT_SETS["full"]
    ours = [result.joint_names.index(name) for name in joints]
    theirs = [truth.names.index(name) for name in joints]
    settled = np.flatnonzero(truth.visible & (truth.times_s >= appears_s + SETTLED_S))
    off_cm = []
    for row in settled:
        k = np.flatnonzero(np.abs(result.times_s - truth.times_s[row]) < 1e-3)
        if len(k):
            off_m = result.joints_m[k[0], ours] - truth.joints_m[row, theirs]
            off_cm.append(100.0 * np.linalg.norm(off_m, axis=1).mean())
    with_person = result.times_s[result.times_s >= appears_s - 1e-3]
    return Outcome(
        folder.name,
        float(with_person[0] - appears_s) if len(with_person) else np.inf,
        len(off_cm) / max(len(settled), 1),
        float(np.mean(off_cm)) if off_cm else np.nan,
        len(result.times_s) - len(with_person),
        LostReason.UNRECOGNISED.what if result.unrecognised else "",
    )


def ghosts(thing: MovedThing, tracker: str) -> int:
    """Frames with a body where only a thing is moved."""
    known, frames = filmed(thing)
    ready = ready_tracker(tracker, known, Resources())
    return len(track_all(ready.tracker, ready.shape, frames, lambda _: None).times_s)


def main(words: list[str]) -> int:
    """Print the table; 0 when enough is found and the rest has a reason."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--tracker", default="markerless")
    everything = [one.name for one in (*SESSIONS, *THINGS)]
    parser.add_argument("--only", nargs="*", default=everything)
    chosen = parser.parse_args(words)
    outcomes = []
    for session in SESSIONS:
        if session.name not in chosen.only:
            continue
        folder = chosen.folder / session.name
        if not (folder / "truth.npz").is_file() or not (folder / "rig.json").is_file():
            record(session, folder)
        outcomes.append(outcome(folder, chosen.tracker))
        print(f"{len(outcomes)}: {outcomes[-1]}", file=sys.stderr, flush=True)
    rigs = {one.name: one.rig for one in SESSIONS}
    rows = [
        [
            one.name, rigs[one.name], number(one.first_s, 2), f"{100 * one.found:.0f} %", number(one.mean_cm, 1),
            str(one.ghosts), "yes" if one.passes else "no", one.reason or "-",
        ]
        for one in outcomes
    ]  # fmt: skip
    print(table(_HEADS, rows))
    passed = sum(one.passes for one in outcomes)
    print(f"{passed} of {len(outcomes)} found")
    found = {one.name: ghosts(one, chosen.tracker) for one in THINGS if one.name in chosen.only}
    if found:
        print(table(("moved, and nobody there", "ghosts"), [(k, str(n)) for k, n in found.items()]))
    untold = [one.name for one in outcomes if not one.passes and not one.reason]
    return 0 if passed >= _NEEDED and not untold and not any(found.values()) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
