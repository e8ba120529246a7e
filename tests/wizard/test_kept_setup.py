"""A setup that survives the end of its process: what is kept, what is offered, and what is not."""

import stat
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from pathlib import Path

import numpy as np
import pytest

from mocapd.calibration.calibration_file import read_calibration
from mocapd.capture.webcam.camera_controls import Control
from mocapd.capture.webcam.v4l2 import WebcamSettings
from mocapd.errors import ConfigError, MocapdError
from mocapd.wizard.cameras.camera_locks import CameraLocks
from mocapd.wizard.draft import Draft, DraftCamera
from mocapd.wizard.setup_keeper import (
    FILE_NAME,
    OF_EARLIER_VERSIONS,
    SetupKeeper,
    UnfinishedSetup,
    read_draft,
    unfinished_cameras,
    write_draft,
)
from mocapd.wizard.step_names import StepName
from tests.wizard.drafts import begun, drafted, full_draft, same
from tests.wizard.fake_webcam import FakeWebcam

WHEN = datetime(2026, 11, 22, 10, 0, tzinfo=UTC)
DONE = frozenset({StepName.CAMERAS, StepName.LENS})
NO_LOCKS = CameraLocks(())


def keep(folder: Path, draft: Draft, when: datetime = WHEN) -> Path:
    path = folder / FILE_NAME
    write_draft(path, UnfinishedSetup(when, DONE, draft))
    return path


def keeper(folder: Path, draft: Draft, now: datetime = WHEN) -> SetupKeeper:
    return SetupKeeper(folder, draft, NO_LOCKS, lambda: now)


def test_all_of_it_comes_back_but_the_password(tmp_path: Path) -> None:
    draft = drafted()
    path = keep(tmp_path / "state", draft)
    assert stat.S_IMODE(path.stat().st_mode) == 0o600
    assert stat.S_IMODE(path.parent.stat().st_mode) == 0o700
    assert b"hunter2" not in path.read_bytes()
    read = read_draft(path)
    assert (read.when, read.done) == (WHEN, DONE)
    assert read.draft.cameras[1].source == "rtsp://admin:***@10.0.0.7/live"
    assert same(replace(read.draft, cameras=draft.cameras), draft)
    setup = keeper(tmp_path / "state", begun(draft))
    assert setup.offer is not None
    assert same(setup.resume().draft, draft)  # the password is that of the camera that is open
    setup.close()


def test_nothing_is_all_that_comes_back_of_a_draft_without_anything(tmp_path: Path) -> None:
    empty = begun(full_draft())
    assert same(read_draft(keep(tmp_path, empty)).draft, empty)


def test_damage_is_refused_by_name_or_leaves_a_draft(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    path = keep(tmp_path, drafted())
    data = path.read_bytes()
    random = np.random.default_rng(3)
    refused = 0
    for _ in range(60):
        broken = bytearray(data)
        broken[random.integers(len(data))] ^= 1 << random.integers(8)
        path.write_bytes(broken if random.random() < 0.7 else broken[: random.integers(len(data))])
        try:
            read_draft(path)
        except MocapdError:
            refused += 1
    assert refused > 20
    path.write_bytes(data[: len(data) // 2])
    setup = keeper(tmp_path, begun(drafted()))
    assert setup.offer is None
    assert not path.exists()
    assert "cannot be used" in caplog.text
    setup.close()


@pytest.mark.parametrize(
    ("before", "after", "named"),
    [
        ("ids = [0, 1,", "ids = [1, 0,", "another board"),
        ("ids = [0, 1,", "ids = [1,", "another board"),
        ('done = [\n    "cameras",', 'done = [\n    "lunch",', "'lunch'"),
        ("size_px = [64, 48]", "size_px = [0, 48]", "size_px"),
        ('id = "cam1"', 'id = "cam0"', "two cameras"),
        ("[setup]", "[upset]", "was finished"),
    ],
)
def test_what_cannot_be_is_named(tmp_path: Path, before: str, after: str, named: str) -> None:
    path = keep(tmp_path, drafted())
    text = path.read_text()
    assert before in text
    path.write_text(text.replace(before, after))
    with pytest.raises(MocapdError, match=named):
        read_draft(path)


def test_another_schema_is_not_gone_on_with(tmp_path: Path) -> None:
    path = keep(tmp_path, drafted())
    path.write_text(path.read_text().replace("schema = 1\n", "schema = 2\n"))
    setup = keeper(tmp_path, begun(drafted()))
    assert setup.offer is None
    assert not path.exists()
    setup.close()


def test_it_is_no_calibration_to_track_by_until_the_cameras_are_placed(tmp_path: Path) -> None:
    path = keep(tmp_path, replace(drafted(), rig=None, extrinsics_quality=None))
    with pytest.raises(ConfigError, match="not finished"):
        read_calibration(path)


def test_one_of_an_earlier_version_is_named_and_left(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    earlier = tmp_path / OF_EARLIER_VERSIONS
    earlier.write_bytes(b"of a mocapd before")
    setup = keeper(tmp_path, begun(drafted()))
    assert setup.offer is None
    assert str(earlier) in caplog.text
    assert earlier.exists()
    setup.close()


@pytest.mark.parametrize("days", [0, 6, 8])
def test_an_old_one_is_forgotten(tmp_path: Path, days: int) -> None:
    path = keep(tmp_path, drafted())
    setup = keeper(tmp_path, begun(drafted()), WHEN + timedelta(days=days))
    assert (setup.offer is not None) is (days < 7) is path.exists()
    setup.close()


def test_one_of_other_cameras_is_not_offered(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level("INFO")
    path = keep(tmp_path, drafted())
    moved = tuple(replace(one, source="usb:9-9:046d:0825:x") for one in drafted().cameras)
    setup = keeper(tmp_path, Draft(cameras=moved))
    assert setup.offer is None
    assert not path.exists()
    assert "of other cameras" in caplog.text
    setup.close()


def test_a_camera_left_out_then_may_be_there_now(tmp_path: Path) -> None:
    keep(tmp_path, drafted())
    more = (*drafted().cameras, DraftCamera("cam2", "/dev/video9", (640, 480)))
    setup = keeper(tmp_path, Draft(cameras=more))
    assert [one.id for one in setup.resume().draft.cameras] == ["cam0", "cam1"]
    setup.close()


def test_webcams_are_set_to_what_was_found_and_others_must_fit(tmp_path: Path) -> None:
    draft = replace(drafted(), intrinsics_saved=frozenset({"cam1"}))
    keep(tmp_path, draft)
    webcam = FakeWebcam("cam0")
    locks = CameraLocks((webcam,))
    # both are open in another mode than then; cam1 cannot be set
    opened = tuple(replace(one, size_px=(640, 480)) for one in draft.cameras)
    locks.set_free("cam0")
    setup = SetupKeeper(tmp_path, Draft(cameras=opened), locks, lambda: WHEN)
    found = setup.resume().draft
    one, other = found.cameras
    assert one == draft.cameras[0]
    assert webcam.settings == WebcamSettings(one.size_px, one.fps_hz, one.controls)
    assert webcam.values[Control.AUTO_EXPOSURE] == 1
    assert webcam.values[Control.EXPOSURE] == one.controls.exposure
    assert other.size_px == (640, 480)
    assert set(found.intrinsics) == set(found.colours) == {"cam0"}
    assert found.rig is None
    locks.restore()
    assert webcam.values[Control.AUTO_EXPOSURE] == 3  # as it was before the setup
    setup.close()


def test_cameras_are_opened_under_the_names_and_in_the_modes_they_had(tmp_path: Path) -> None:
    kept, saved = (
        drafted().cameras,
        (
            DraftCamera("cam0", "usb:3-1:1:1:a", (640, 480)),
            DraftCamera("left", "usb:3-2:1:1:b", (640, 480)),
        ),
    )
    assert unfinished_cameras(tmp_path, saved) == saved
    keep(tmp_path, drafted())
    assert [one.id for one in unfinished_cameras(tmp_path, saved)] == ["cam0", "cam1", "left"]
    assert unfinished_cameras(tmp_path, saved)[0] == kept[0]
