"""A live setup takes positions of the board at rest: what a camera's stamps are off by moves no camera."""

import numpy as np
import pytest

from mocapd.calibrate.board.board_instant import BoardInstant, BoardObservation, motion_px
from mocapd.calibrate.board.board_sightings import BoardSightings
from mocapd.calibrate.extrinsics.board_extrinsics import place_in_world, solve_extrinsics
from mocapd.calibrate.extrinsics.live_extrinsics import PARAMS
from mocapd.calibrate.intrinsics.intrinsics import Intrinsics
from tests.calibrate.moving_board import BOARD_M, SPEC, Clock, Session, errors, record, rig_of

RIG = rig_of(3, 1.2)
_FPS = 30.0
_EVERY = 3  # frames between instants


def sightings_of(session: Session) -> BoardSightings:
    """What the step Room collects from instants at the cameras' newest pictures, by their stamps."""
    recordings, _ = record(session)
    collected = BoardSightings({camera.name: camera.size_px for camera in session.rig}, BOARD_M)
    before: dict[str, BoardObservation] = {}
    for index in range(0, int(session.seconds_s * _FPS), _EVERY):
        t_ns = int(1e9 * index / _FPS)
        seen = {}
        for one in recordings:
            name, view = one.recording.name, one.views.get(index)
            if view is not None:
                moved_px = motion_px(before.get(name), view, t_ns)
                seen[name] = BoardObservation(view, t_ns, moved_px)
        before.update(seen)
        collected.offer(BoardInstant(index, t_ns, {}, seen))
    return collected


@pytest.mark.parametrize("late_frames", [2.5, -5.0])
def test_stamps_that_are_wrong_leave_the_rig_right(late_frames: float) -> None:
    clocks = {"cam2": Clock(late_frames / _FPS)}
    session = Session(RIG, clocks, seconds_s=40.0, speed_mps=0.4, rest=0.6, seed=5)
    collected = sightings_of(session)
    assert collected.count >= 10
    lenses = {
        c.name: Intrinsics(c.size_px, c.K, c.dist, np.ones(5, bool), 0, 0, (), (), 0.005)
        for c in RIG
    }
    found = solve_extrinsics(lenses, collected.views, SPEC, PARAMS)
    made = place_in_world(found, None, "", PARAMS)
    cm, deg = errors(RIG, made.rig.cameras)
    assert made.play_area is not None
    assert cm < 2.0 * made.play_area.median_cm < 6.0
    assert deg < 1.0
    assert made.rms_px < 0.5
