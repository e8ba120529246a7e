"""Board recordings out of step: the offset is found from the board's motion, and told of; in step nothing is."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from mocapd.calibrate.extrinsics.folder_alignment import AlignedViews, align_views
from mocapd.calibrate.extrinsics.folder_calibration import (
    FolderParams,
    calibrate_folder,
    refuse_contradicted_lenses,
)
from mocapd.calibrate.intrinsics.intrinsics import Intrinsics
from mocapd.errors import ConfigError
from mocapd.types import Camera, Rig
from tests.calibrate.moving_board import BOARD_M, SPEC, Clock, Session, record, rig_of

RIG = rig_of(2, 1.0)


def lenses(rig: tuple[Camera, ...], off: float = 1.01) -> dict[str, Intrinsics]:
    """As each camera alone knows them: the focal length a little off."""
    return {
        c.name: Intrinsics(
            c.size_px, c.K * [[off], [off], [1]], c.dist, np.ones(5, bool), 0, 0, (), (), 0.01
        )
        for c in rig
    }


def aligned(
    clocks: Mapping[str, Clock], rig: tuple[Camera, ...] = RIG, seed: int = 3, most: int = 200
) -> AlignedViews:
    session = Session(rig, clocks, seconds_s=5.0, speed_mps=0.3, seed=seed)
    sightings, stamps = record(session)
    views = {one.recording.name: one.views for one in sightings}
    return align_views(views, lenses(rig), stamps, BOARD_M, most)


@pytest.mark.parametrize(
    ("late_frames", "hz"), [(2.0, 30.0), (-4.4, 30.0), (1.3, 25.0), (3.0, 15.0), (45.0, 30.0)]
)
def test_the_offset_is_found_to_a_quarter_frame(late_frames: float, hz: float) -> None:
    found = aligned({"cam1": Clock(late_frames / hz, hz=hz)})
    assert found.delay_frames("cam1", "cam0", 0.0) == pytest.approx(late_frames, abs=0.25)
    side = "behind" if late_frames > 0.0 else "ahead of"
    assert f"{side} cam0" in found.times.troubles()[0]


@pytest.mark.parametrize("seed", [1, 2])
def test_cameras_in_step_stay_as_they_are(seed: int) -> None:
    found = aligned({}, rig_of(3, 1.6), seed)
    assert found.times.troubles() == ()
    for name, own in found.instants.lags.items():
        assert max(map(abs, own.values())) < 1e-9, name
        assert all(instant == index for instant, index in found.instants.source[name].items())


@pytest.mark.parametrize(("late_frames", "step"), [(0.0, 3), (0.5, 1)])
def test_positions_are_spread_evenly_unless_motion_must_be_followed(
    late_frames: float, step: int
) -> None:
    found = aligned({"cam1": Clock(late_frames / 30.0)}, most=60)
    instants = sorted(found.instants.source["cam0"])
    assert 40 <= len(instants) <= 60
    assert np.median(np.diff(instants)) == step


def test_frames_that_the_stamps_show_as_lost_are_no_trouble() -> None:
    found = aligned({"cam1": Clock(lost=(40, 41, 90))})
    assert found.times.troubles() == ()
    assert found.instants.source["cam1"][100] == 97


def test_a_frame_lost_without_a_trace_is_said_with_its_time() -> None:
    found = aligned({"cam1": Clock(lost=(75,), stamped=False)})
    assert "cam1 loses 1 frame near 2." in found.times.troubles()[0]
    # both ends are paired rightly
    assert found.instants.source["cam1"][30] == 30
    assert found.instants.source["cam1"][120] == 119


def test_a_room_that_wants_another_lens_is_refused() -> None:
    rig = Rig(tuple(replace(c, K=c.K * [[1.2], [1.2], [1.0]]) for c in RIG))
    with pytest.raises(ConfigError, match=r"focal length of 5.. px \(known to 1.0 %\)"):
        refuse_contradicted_lenses(rig, lenses(RIG))
    refuse_contradicted_lenses(Rig(RIG), lenses(RIG))


@pytest.mark.parametrize(("folder", "late"), [("01-two-frames-late", 2.0)])
def test_a_camera_that_was_started_late(shared_dir: Path, folder: str, late: float) -> None:
    """Its truth: 1.000 m apart."""
    recordings = shared_dir / "findings" / "reports-2026-11-26" / folder
    if not recordings.is_dir():
        pytest.skip(f"{folder} is missing in ../shared")
    params = FolderParams(most_pictures=40, densely=2, most_views=12)
    found = calibrate_folder(recordings, SPEC, lambda *_: None, params=params)
    assert found.cameras["right"].delay_frames == pytest.approx(late, abs=0.1)
    assert any(f"right is {late:.1f} frames" in note for note in found.notes)
    left, right = found.rig.cameras
    between_m = np.linalg.norm(left.R.T @ left.t_m - right.R.T @ right.t_m)
    assert found.play_area is not None
    assert 100.0 * abs(between_m - 1.0) < 2.0 * found.play_area.median_cm < 4.0
