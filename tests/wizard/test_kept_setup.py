"""A setup that survives the end of its process: what is kept, what is offered, and what is not."""

import hashlib
import stat
from dataclasses import fields, replace
from datetime import UTC, datetime, timedelta
from pathlib import Path

import msgspec
import numpy as np
import pytest

from mocapd.capture.webcam.camera_controls import Control
from mocapd.capture.webcam.v4l2 import WebcamSettings
from mocapd.errors import MocapdError
from mocapd.wizard.cameras.camera_locks import CameraLocks
from mocapd.wizard.draft import Draft, DraftCamera
from mocapd.wizard.kept_setup import FILE_NAME, KeptSetup, _Kept, read_kept, write_kept
from mocapd.wizard.setup_keeper import SetupKeeper, kept_cameras
from mocapd.wizard.step_names import StepName
from tests.wizard.drafts import begun, drafted, full_draft, same
from tests.wizard.fake_webcam import FakeWebcam

WHEN = datetime(2026, 11, 22, 10, 0, tzinfo=UTC)
DONE = frozenset({StepName.CAMERAS, StepName.LENS})
NO_LOCKS = CameraLocks(())


def keep(folder: Path, draft: Draft, when: datetime = WHEN) -> Path:
    path = folder / FILE_NAME
    write_kept(path, KeptSetup(when, DONE, draft))
    return path


def keeper(folder: Path, draft: Draft, now: datetime = WHEN) -> SetupKeeper:
    return SetupKeeper(folder, draft, NO_LOCKS, lambda: now)


def test_all_of_it_comes_back_but_the_password(tmp_path: Path) -> None:
    draft = drafted()
    path = keep(tmp_path / "state", draft)
    assert stat.S_IMODE(path.stat().st_mode) == 0o600
    assert stat.S_IMODE(path.parent.stat().st_mode) == 0o700
    assert b"hunter2" not in path.read_bytes()
    read = read_kept(path)
    assert (read.when, read.done) == (WHEN, DONE)
    assert read.draft.cameras[1].source == "rtsp://admin:***@10.0.0.7/live"
    assert same(replace(read.draft, cameras=draft.cameras), draft)
    setup = keeper(path.parent, begun(draft))
    assert setup.offer is not None
    assert same(setup.resume().draft, draft)  # the password is that of the camera that is open
    setup.close()


def test_nothing_is_all_that_comes_back_of_a_draft_without_anything(tmp_path: Path) -> None:
    empty = begun(full_draft())
    assert same(read_kept(keep(tmp_path, empty)).draft, empty)


def test_damage_is_found_and_the_file_taken_away(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level("INFO")
    path = keep(tmp_path, drafted())
    data = path.read_bytes()
    random = np.random.default_rng(3)
    for _ in range(200):
        broken = bytearray(data)
        broken[random.integers(len(data))] ^= 1 << random.integers(8)
        path.write_bytes(broken if random.random() < 0.7 else broken[: random.integers(len(data))])
        with pytest.raises(MocapdError):
            read_kept(path)
    setup = keeper(tmp_path, begun(drafted()))
    assert setup.offer is None
    assert not path.exists()
    assert "its checksum does not fit" in caplog.text
    setup.close()


def test_what_is_whole_but_cannot_be_is_named(tmp_path: Path) -> None:
    """As if somebody had made the file: every number replaced by what it cannot be."""
    path = keep(tmp_path, drafted())
    body = path.read_bytes()[32:]
    tree = msgspec.msgpack.decode(body)
    wrong: tuple[object, ...] = (None, -1, 10**18, float("nan"), float("inf"), "x", [], {}, b"x")
    refused = 0
    places = list(places_of(tree))
    random = np.random.default_rng(4)
    for index in random.choice(len(places), 40, replace=False):
        holder, key = places[index]
        before = holder[key]
        for value in wrong:
            holder[key] = value
            changed = msgspec.msgpack.encode(tree)
            path.write_bytes(hashed(changed))
            try:
                read_kept(path)
            except MocapdError:
                refused += 1
        holder[key] = before
    assert refused > 240


def places_of(tree: object) -> list[tuple[dict[object, object] | list[object], object]]:
    """Every place in a tree: who holds it, and its key."""
    items: list[tuple[object, object]] = []
    if isinstance(tree, dict):
        items = list(tree.items())
    elif isinstance(tree, list):
        items = list(enumerate(tree))
    found: list[tuple[dict[object, object] | list[object], object]] = []
    for key, value in items:
        assert isinstance(tree, dict | list)
        found += [(tree, key), *places_of(value)]
    return found


def hashed(body: bytes) -> bytes:
    return hashlib.sha256(body).digest() + body


def test_another_schema_is_not_gone_on_with(tmp_path: Path) -> None:
    path = keep(tmp_path, drafted())
    tree = msgspec.msgpack.decode(path.read_bytes()[32:])
    tree["schema"] = 2
    path.write_bytes(hashed(msgspec.msgpack.encode(tree)))
    setup = keeper(tmp_path, begun(drafted()))
    assert setup.offer is None
    assert not path.exists()
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
    assert kept_cameras(tmp_path, saved) == saved
    keep(tmp_path, drafted())
    assert [one.id for one in kept_cameras(tmp_path, saved)] == ["cam0", "cam1", "left"]
    assert kept_cameras(tmp_path, saved)[0] == kept[0]


# -- in the wizard -------------------------------------------------------------------------------


def test_every_part_of_a_draft_has_its_place_in_the_file() -> None:
    told = {field.name for field in msgspec.structs.fields(_Kept)}
    assert told == {"schema", "when", "done", "draft"}
    kept = next(f.type for f in msgspec.structs.fields(_Kept) if f.name == "draft")
    assert {f.name for f in msgspec.structs.fields(kept)} == {f.name for f in fields(Draft)}


def test_the_file_keeps_the_words_that_earlier_versions_wrote() -> None:
    kept = next(f.type for f in msgspec.structs.fields(_Kept) if f.name == "draft")
    words = {f.encode_name for f in msgspec.structs.fields(kept)}
    assert {"lenses", "lens_saved", "room", "board_views", "stature_m"} <= words
