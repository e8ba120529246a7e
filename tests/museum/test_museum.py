"""What any mocapd has written is read by this one; what cannot be is refused or set aside, and never written over."""

import json
import logging
import re
import shutil
import tomllib
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from datetime import timedelta
from pathlib import Path

import msgspec
import numpy as np
import pytest

from mocapd.calibration.calibration_file import FILE_NAME, from_saved, read_calibration
from mocapd.calibration.saved_sources import SECRETS, stored_sources
from mocapd.errors import ConfigError, InputError, MocapdError, NewerFileError
from mocapd.geometry.rig_file import load_rig
from mocapd.outputs.mcap.recording_reader import RecordingReader
from mocapd.outputs.wire import SkeletonFrame
from mocapd.service.room_memory import DIGEST_BYTES, RoomMemory, digest_of, read_rooms
from mocapd.service.room_memory import FILE_NAME as ROOMS
from mocapd.types import Camera
from mocapd.web.stored_key import stored_key
from mocapd.wizard.cameras.camera_locks import CameraLocks
from mocapd.wizard.intrinsics.saved_intrinsics import FILE_NAME as LENSES
from mocapd.wizard.intrinsics.saved_intrinsics import read_intrinsics, store_intrinsics
from mocapd.wizard.saving import load_draft, save_draft
from mocapd.wizard.setup_keeper import FILE_NAME as DRAFT
from mocapd.wizard.setup_keeper import OF_EARLIER_VERSIONS, SetupKeeper, read_draft
from tests.museum.make_exhibit import PASSWORD, URL, WHEN, make_exhibit
from tests.outputs.test_recording import write_foreign
from tests.wizard.drafts import full_draft

HERE = Path(__file__).parent
EXHIBITS = sorted(HERE.glob("of_*"))
NEWEST = EXHIBITS[-1]
NO_LOCKS = CameraLocks(())


def with_a(name: str) -> list[Path]:
    """The exhibits that hold it."""
    found = [one for one in EXHIBITS if (one / name).exists()]
    assert found, name
    return found


@pytest.fixture
def state(tmp_path: Path) -> Path:
    """The newest state directory, to be damaged."""
    return Path(shutil.copytree(NEWEST / "state", tmp_path / "state"))


def aside(path: Path, why: str = "corrupt") -> list[Path]:
    """What was set aside of that file."""
    found = sorted(path.parent.glob(f"{path.name}.*"))
    assert all(
        re.fullmatch(rf"{why}-\d{{8}}T\d{{6}}Z(-\d+)?", one.name[len(path.name) + 1 :])
        for one in found
    )
    return found


def cameras_of(exhibit: Path) -> dict[str, Camera]:
    """Those of its rig, by name."""
    return {one.name: one for one in load_rig(exhibit / "rig.json").cameras}


# -- of each version --------------------------------------------------------------------------------


@pytest.mark.parametrize("exhibit", with_a(f"state/{FILE_NAME}"), ids=lambda one: one.name)
def test_a_calibration_of_any_version_is_tracked_with(exhibit: Path) -> None:
    saved = read_calibration(exhibit / "state" / FILE_NAME)
    known = from_saved(saved, exhibit / "state" / FILE_NAME)
    assert known.rig is not None
    assert len(known.rig.cameras) == 2
    assert known.wearer.stature_m in (1.71, 1.72)
    assert known.wearer.shape_factors is not None
    assert known.shirt is not None
    assert known.shirt.white_balance
    assert load_draft(exhibit / "state").rig is not None


@pytest.mark.parametrize("exhibit", with_a(f"state/{SECRETS}"), ids=lambda one: one.name)
def test_passwords_of_any_version_complete_their_sources(exhibit: Path) -> None:
    assert read_calibration(exhibit / "state" / FILE_NAME).camera[1].source == URL
    assert PASSWORD not in (exhibit / "state" / FILE_NAME).read_text()


@pytest.mark.parametrize("exhibit", with_a(f"state/{LENSES}"), ids=lambda one: one.name)
def test_lenses_of_any_version_are_offered(exhibit: Path) -> None:
    (lens,) = read_intrinsics(exhibit / "state")
    assert lens.camera == "046d:0825:cam0"
    assert lens.intrinsics().size_px == (64, 48)


@pytest.mark.parametrize("exhibit", with_a(f"state/{DRAFT}"), ids=lambda one: one.name)
def test_a_setup_in_progress_is_gone_on_with(exhibit: Path, tmp_path: Path) -> None:
    state = shutil.copytree(exhibit / "state", tmp_path / "state")
    kept = read_draft(state / DRAFT)
    now = kept.when + timedelta(hours=1)
    keeper = SetupKeeper(state, kept.draft, NO_LOCKS, lambda: now)
    assert keeper.offer is not None
    draft = keeper.resume().draft
    assert draft.rig is not None
    assert draft.stature_m == 1.72
    assert set(draft.colours) == {"cam0", "cam1"}
    keeper.close()


@pytest.mark.parametrize(
    "exhibit", with_a(f"state/{OF_EARLIER_VERSIONS}"), ids=lambda one: one.name
)
def test_a_setup_in_progress_of_an_earlier_version_is_named_and_left(
    exhibit: Path, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    state = shutil.copytree(exhibit / "state", tmp_path / "state")
    keeper = SetupKeeper(state, full_draft(), NO_LOCKS, lambda: WHEN)
    assert keeper.offer is None
    keeper.close()
    assert "go on with that version" in caplog.text
    assert (state / OF_EARLIER_VERSIONS).exists()


@pytest.mark.parametrize("exhibit", with_a(f"state/{ROOMS}"), ids=lambda one: one.name)
def test_rooms_of_any_version_are_remembered(exhibit: Path) -> None:
    rooms = RoomMemory(exhibit / "state").read(cameras_of(exhibit))
    assert {name: len(views) for name, views in rooms.items()} == {"cam0": 1, "cam1": 1}
    assert rooms["cam0"][0].places.size


@pytest.mark.parametrize("exhibit", with_a("rig.json"), ids=lambda one: one.name)
def test_a_rig_of_any_version_loads(exhibit: Path) -> None:
    assert load_rig(exhibit / "rig.json").names == ("cam0", "cam1")


@pytest.mark.parametrize("name", ["packed.mcap", "exact.mcap"])
@pytest.mark.parametrize("exhibit", with_a("packed.mcap"), ids=lambda one: one.name)
def test_a_recording_of_any_version_is_read(exhibit: Path, name: str) -> None:
    frames = [
        one
        for one in RecordingReader(exhibit / name).everything()
        if isinstance(one, SkeletonFrame)
    ]
    assert len(frames) == (30 if name == "packed.mcap" else 6)
    assert [one.seq for one in frames] == sorted(one.seq for one in frames)
    assert frames[0].joints["leftHand"].p[1] > frames[0].joints["rightHand"].p[1]


@pytest.mark.parametrize("exhibit", with_a("track.npz"), ids=lambda one: one.name)
def test_a_track_of_any_version_has_what_its_readers_ask_for(exhibit: Path) -> None:
    with np.load(exhibit / "track.npz", allow_pickle=False) as track:
        assert str(track.get("schema", "mocapd.Track.v1")) == "mocapd.Track.v1"
        frames, joints = len(track["times"]), len(track["joint_names"])
        assert track["joints"].shape == (frames, joints, 3)
        assert track["global_quats"].shape == (frames, joints, 4)
        assert track["confidence"].shape == (frames, joints)


@pytest.mark.parametrize("name", ["frames.key", "metrics.key"])
def test_keys_stay_those_that_were_given_away(state: Path, name: str) -> None:
    before = (state / name).read_bytes()
    assert stored_key(state / name) == before.decode().strip()
    assert (state / name).read_bytes() == before


# -- the present -------------------------------------------------------------------------------------


def test_what_is_written_now_is_of_the_newest_exhibit(tmp_path: Path) -> None:
    """Else make another one: see README.md."""
    make_exhibit(tmp_path)
    assert _layout(tmp_path) == _layout(NEWEST)


def _layout(folder: Path) -> dict[str, set[str]]:
    """The keys of every file that has some."""
    state = folder / "state"
    layout = {}
    for name in (FILE_NAME, SECRETS, LENSES, DRAFT):
        layout[name] = set(_keys(tomllib.loads((state / name).read_text())))
    layout[ROOMS] = set(_keys(msgspec.msgpack.decode((state / ROOMS).read_bytes()[DIGEST_BYTES:])))
    layout["rig.json"] = set(_keys(json.loads((folder / "rig.json").read_text())))
    with np.load(folder / "track.npz") as track:
        layout["track.npz"] = set(track.files)
    for name in ("packed.mcap", "exact.mcap"):
        schemas = re.findall(
            rb"(?:mocapd|foxglove)\.[A-Za-z.]+\.?v?\d*", (folder / name).read_bytes()
        )
        layout[name] = {one.decode() for one in schemas}
    assert all(layout.values())
    return layout


def _keys(tree: object, way: str = "") -> Iterable[str]:
    """Every way to a value; what stands in a list is alike."""
    if isinstance(tree, Mapping):
        for name, item in tree.items():
            yield from _keys(item, f"{way}.{name}")
    elif isinstance(tree, list):
        for item in tree:
            yield from _keys(item, f"{way}[]")
    else:
        yield way


# -- damaged, cut short, of the future ---------------------------------------------------------------


def future_toml(data: bytes) -> bytes:
    assert data.count(b"schema = 1\n") == 1
    return data.replace(b"schema = 1\n", b"schema = 2\n")


def future_rooms(data: bytes) -> bytes:
    body = msgspec.msgpack.encode({"schema": 2, "what": "nobody knows yet"})
    return digest_of(body) + body


def cut_short(data: bytes) -> bytes:
    return data[: len(data) * 2 // 3]


def other_bytes(data: bytes) -> bytes:
    return data[:200] + bytes(255 - one for one in data[200:300]) + data[300:]


Change = Callable[[bytes], bytes]


def changed(path: Path, change: Change) -> bytes:
    """The file is damaged so; what it holds then."""
    data = change(path.read_bytes())
    path.write_bytes(data)
    return data


@pytest.mark.parametrize("change", [cut_short, other_bytes])
@pytest.mark.parametrize(
    ("name", "read"),
    [
        (f"state/{FILE_NAME}", read_calibration),
        (f"state/{SECRETS}", lambda path: stored_sources(path.parent)),
        (f"state/{LENSES}", lambda path: read_intrinsics(path.parent)),
        (f"state/{DRAFT}", read_draft),
        (f"state/{ROOMS}", lambda path: read_rooms(path, {})),
        ("rig.json", load_rig),
        ("state/frames.key", stored_key),
    ],
)
def test_a_damaged_file_is_refused_by_name_and_left_as_it_is(
    tmp_path: Path, name: str, read: Callable[[Path], object], change: Change
) -> None:
    folder = shutil.copytree(NEWEST, tmp_path / "exhibit")
    path = folder / name
    data = (
        cut_short(path.read_bytes()) if len(path.read_bytes()) < 300 else change(path.read_bytes())
    )
    path.write_bytes(data)
    with pytest.raises(MocapdError):
        read(path)
    assert path.read_bytes() == data


def test_a_calibration_of_the_future_is_refused_with_its_schema(state: Path) -> None:
    data = changed(state / FILE_NAME, future_toml)
    with pytest.raises(NewerFileError, match=r"schema 2, this mocapd reads schema 1.*wrote it"):
        read_calibration(state / FILE_NAME)
    assert (state / FILE_NAME).read_bytes() == data


@pytest.mark.parametrize("why", ["corrupt", "newer"])
def test_a_calibration_that_cannot_be_read_is_set_aside_by_the_next_save(
    state: Path, why: str, caplog: pytest.LogCaptureFixture
) -> None:
    bare = replace(full_draft(), colours={})
    for draft in (bare, bare, full_draft()):  # so that the one before names no picture
        save_draft(draft, state)
    previous = (state / "calibration.previous.toml").read_bytes()
    data = changed(state / FILE_NAME, future_toml if why == "newer" else other_bytes)
    pictures = {one.name for one in (state / "colours").iterdir()}
    save_draft(bare, state)
    (kept,) = aside(state / FILE_NAME, why)
    assert kept.read_bytes() == data
    assert kept.stat().st_mode & 0o077 == 0
    assert (state / "calibration.previous.toml").read_bytes() == previous
    assert pictures
    assert {one.name for one in (state / "colours").iterdir()} == pictures
    assert read_calibration(state / FILE_NAME).camera[0].colour is None
    assert kept.name in caplog.text


@pytest.mark.parametrize("why", ["corrupt", "newer"])
def test_lenses_that_cannot_be_read_are_set_aside_by_the_next_save(state: Path, why: str) -> None:
    data = changed(state / LENSES, future_toml if why == "newer" else cut_short)
    store_intrinsics(full_draft(), state, WHEN)
    (kept,) = aside(state / LENSES, why)
    assert kept.read_bytes() == data
    assert len(read_intrinsics(state)) == 2


@pytest.mark.parametrize("why", ["corrupt", "newer"])
def test_a_setup_in_progress_that_cannot_be_read_is_set_aside_and_told(
    state: Path, why: str, caplog: pytest.LogCaptureFixture
) -> None:
    data = changed(state / DRAFT, future_toml if why == "newer" else cut_short)
    caplog.set_level(logging.WARNING)
    keeper = SetupKeeper(state, full_draft(), NO_LOCKS, lambda: WHEN)
    assert keeper.offer is None
    keeper.close()
    (kept,) = aside(state / DRAFT, why)
    assert kept.read_bytes() == data
    assert kept.name in caplog.text


@pytest.mark.parametrize("why", ["corrupt", "newer"])
def test_rooms_that_cannot_be_read_are_set_aside_and_told(
    state: Path, why: str, caplog: pytest.LogCaptureFixture
) -> None:
    data = changed(state / ROOMS, future_rooms if why == "newer" else cut_short)
    cameras = cameras_of(NEWEST)
    memory = RoomMemory(state)
    assert memory.read(cameras) == {}
    (kept,) = aside(state / ROOMS, why)
    assert kept.read_bytes() == data
    assert kept.name in caplog.text
    memory.write(cameras, {})
    assert memory.read(cameras) == {}
    assert aside(state / ROOMS, why) == [kept]


def test_passwords_that_cannot_be_read_stop_a_save_before_anything_is_lost(state: Path) -> None:
    before = (state / FILE_NAME).read_bytes()
    for change in (future_toml, cut_short):
        shutil.copy(NEWEST / "state" / SECRETS, state / SECRETS)
        data = changed(state / SECRETS, change)
        with pytest.raises(ConfigError, match=SECRETS):
            save_draft(full_draft(), state)
        assert (state / SECRETS).read_bytes() == data
    assert (state / FILE_NAME).read_bytes() == before


def test_a_rig_of_the_future_is_refused(tmp_path: Path) -> None:
    rig = json.loads((NEWEST / "rig.json").read_text())
    path = tmp_path / "rig.json"
    path.write_text(json.dumps({**rig, "schema": "mocapd.Rig.v2"}))
    with pytest.raises(NewerFileError, match=r"mocapd\.Rig\.v2"):
        load_rig(path)


def test_a_recording_of_the_future_is_refused_with_its_schema(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    write_foreign(path, "mocapd.Skeleton.v2", b"nobody knows yet")
    with pytest.raises(InputError, match=r"another version of mocapd.*Skeleton\.v2"):
        [*RecordingReader(path).everything()]


def test_what_is_set_aside_twice_in_a_second_is_kept_twice(state: Path) -> None:
    for text in ("one", "two", "three"):
        (state / LENSES).write_text(text)
        store_intrinsics(full_draft(), state, WHEN)
    assert sorted(one.read_text() for one in aside(state / LENSES)) == ["one", "three", "two"]
