"""python -m tests.calibrate.time_study [--only N ...] [--jobs J]: board recordings out of step, and in step.

40 simulated recordings whose cameras are out of step by 0.2 to 6 frames: told error against the true one, offset
found. 20 in step: none may be refused or warned of. Corners are simulated, with noise; the calibration is that of
`mocapd calibrate --from-folder` from the corners on.
"""

import argparse
import re
import sys
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass

import numpy as np

from mocapd.calibrate.extrinsics.folder_calibration import FolderParams, calibrate_sightings
from mocapd.errors import ConfigError
from tests.calibrate.moving_board import SPEC, Clock, Session, errors, record, rig_of

_FPS = 30.0
_PARAMS = FolderParams(most_pictures=120)


@dataclass(frozen=True)
class Case:
    """A session, what is wrong with it, and the true offset of the last camera to the first [its frames]."""

    what: str
    session: Session
    late_frames: float = 0.0
    lost: bool = False


@dataclass(frozen=True)
class Outcome:
    """What calibrating gave; told_cm NaN where refused."""

    case: Case
    told_cm: float
    true_cm: float
    true_deg: float
    late_frames: float
    said: str
    wall_s: float

    @property
    def good(self) -> bool:
        """Told honestly, or refused with the offset."""
        if np.isnan(self.told_cm):
            return abs(self.late_frames - self.case.late_frames) <= 0.25
        return self.true_cm <= 2.0 * self.told_cm


def late_cases() -> Iterator[Case]:
    """40 out of step."""
    rng = np.random.default_rng(45)
    offsets = (0.2, 0.35, 0.5, 0.7, 0.9, 1.0, 1.3, 1.5, 2.0, 2.5, 3.0, 3.6, 4.0, 4.4, 5.0, 6.0)
    for k in range(24):
        late = offsets[k % len(offsets)] * (-1.0 if k % 3 == 2 else 1.0)
        cameras = (2, 2, 3, 4)[k % 4]
        rig = rig_of(cameras, (1.0, 0.35, 2.4, 1.6, 0.6)[k % 5], hd=k % 3 == 0)
        clocks = {rig[-1].name: Clock(late / _FPS)}
        if cameras == 4:
            clocks[rig[1].name] = Clock(rng.uniform(-3.0, 3.0) / _FPS)
        yield Case(
            f"{cameras} cameras",
            _session(rig, clocks, k, (0.15, 0.3, 0.5, 0.8)[k % 4], (0.0, 0.0, 0.5)[k % 3]),
            late,
        )
    for k in range(6):  # frames lost without a trace
        rig = rig_of(2 + k % 2, 1.0 + 0.2 * k)
        lost = tuple(sorted(rng.choice(np.arange(30, 180), 1 + k % 3, replace=False).tolist()))
        late = (0.0, 2.0, -1.4)[k % 3]
        clocks = {rig[-1].name: Clock(late / _FPS, lost=lost, stamped=False)}
        yield Case(f"loses {len(lost)}", _session(rig, clocks, 30 + k, 0.3), late, lost=True)
    for k in range(3):  # lost, but stamped
        rig = rig_of(2, 1.0)
        late = (0.0, 1.0, 3.4)[k]
        clocks = {rig[-1].name: Clock(late / _FPS, lost=(40, 41, 95, 140))}
        yield Case("loses 4, stamped", _session(rig, clocks, 40 + k, 0.4), late)
    for k in range(5):  # rates
        rig = rig_of(2 + k % 2, 1.2)
        hz = (15.0, 25.0, 24.0, 15.0, 60.0)[k]
        late = (0.0, 1.3, 0.4, 3.0, 2.0)[k]
        clocks = {rig[-1].name: Clock(late / hz, hz=hz)}
        yield Case(f"{hz:.0f} Hz", _session(rig, clocks, 50 + k, 0.3), late)
    for k in range(2):  # variable rate
        rig = rig_of(2, 0.8)
        late = (0.6, 2.2)[k]
        clocks = {rig[-1].name: Clock(late / _FPS, jitter_s=0.005)}
        yield Case("variable rate", _session(rig, clocks, 60 + k, 0.4), late)


def step_cases() -> Iterator[Case]:
    """20 in step."""
    for k in range(20):
        rig = rig_of((2, 3, 4, 2)[k % 4], (1.0, 0.35, 2.4, 1.6, 0.6)[k % 5], hd=k % 3 == 0)
        speed = (0.15, 0.3, 0.5, 0.8)[k % 4]
        yield Case("in step", _session(rig, {}, 100 + k, speed, (0.0, 0.5)[k % 2]))


def _session(rig, clocks, seed: int, speed_mps: float, rest: float = 0.0) -> Session:  # type: ignore[no-untyped-def]
    return Session(rig, clocks, 7.0, speed_mps, rest, 0.2, seed)


def calibrate(case: Case) -> Outcome:
    """One of them."""
    began_s = time.perf_counter()
    sightings, clocks = record(case.session)
    try:
        found = calibrate_sightings(sightings, clocks, SPEC, lambda *_: None, None, _PARAMS)
    except ConfigError as error:
        numbers = re.findall(r"([\d.]+) frames \(\d+ ms\) (behind|ahead)", str(error))
        refused = [float(n) * (1.0 if side == "behind" else -1.0) for n, side in numbers]
        wall_s = time.perf_counter() - began_s
        return Outcome(case, np.nan, np.nan, np.nan, (refused or [np.nan])[-1], str(error), wall_s)
    cm, deg = errors(case.session.rig, found.rig.cameras)
    told = np.nan if found.play_area is None else found.play_area.median_cm
    late_frames = found.cameras[case.session.rig[-1].name].delay_frames
    said = "; ".join(note for note in found.notes if "floor" not in note)
    return Outcome(case, told, cm, deg, late_frames, said, time.perf_counter() - began_s)


def main() -> int:
    """Prints a table; 0 when all that is wanted is reached."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", type=int, nargs="*")
    parser.add_argument("--jobs", type=int, default=1)
    options = parser.parse_args()
    cases = [*late_cases(), *step_cases()]
    numbers = options.only if options.only else range(len(cases))
    late_good = late = step_quiet = step = 0
    with ProcessPoolExecutor(options.jobs) as pool:
        for n, one in zip(numbers, pool.map(calibrate, [cases[n] for n in numbers]), strict=True):
            print(_line(n, one), flush=True)
            if one.case.what == "in step":
                step += 1
                step_quiet += not one.said
            else:
                late += 1
                late_good += one.good
    print(
        f"out of step: {late_good} of {late} told within a factor of 2, or refused with the offset"
    )
    print(f"in step: {step_quiet} of {step} neither refused nor warned of")
    return 0 if (late_good, step_quiet) == (late, step) else 1


def _line(n: int, one: Outcome) -> str:
    case = one.case
    figures = f"told {one.told_cm:5.2f} cm, true {one.true_cm:5.2f} cm {one.true_deg:5.2f} deg"
    return (
        f"{n:2d} {case.what:17s} {case.session.speed_mps:.2f} m/s, {len(case.session.rig)} cameras, "
        f"late {case.late_frames:5.2f} found {one.late_frames:6.3f}  {figures}  "
        f"{'' if one.good else 'BAD '}{one.wall_s:4.1f} s {one.said}"
    )


if __name__ == "__main__":
    sys.exit(main())
