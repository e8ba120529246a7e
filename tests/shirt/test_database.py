"""The pose database: its poses, its neighbours, its file."""

import random
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import NoReturn

import numpy as np
import pytest

from mocapd.body.joint_limits import swing_twist
from mocapd.body.pose_space import upper_body
from mocapd.errors import CannotCreateError
from mocapd.geometry import rotations
from mocapd.geometry.camera_model import project
from mocapd.shirt.pose_database import database_file
from mocapd.shirt.pose_database.cache_name import BEGINNING_NAME, CACHE_NAME
from mocapd.shirt.pose_database.database import (
    DatabaseParams,
    PoseDatabase,
    build_database,
    camera_from_view,
    content_hash,
)
from mocapd.shirt.pose_database.database_file import (
    LOCK_NAME,
    load_or_build,
    load_or_build_beginning,
    write_database,
)
from mocapd.shirt.pose_database.idmap_crop_kernels import SIZE, crop_id_map, unpack
from mocapd.shirt.pose_database.pose_sampling import SamplingParams, poses_from_cube, random_cube
from mocapd.types import Bytes, Camera

pytestmark = pytest.mark.kernels

SMALL = DatabaseParams(count=1500, cells=24)


def id_map(database: PoseDatabase, i: int) -> Bytes:
    """The 40x40 id map of pose i."""
    out = np.empty((SIZE, SIZE), np.uint8)
    unpack(database.index.packed_maps[i], out)
    return out


@pytest.fixture(scope="module")
def database() -> PoseDatabase:
    return build_database(SMALL)


def test_has_as_many_poses_as_asked_for_and_they_are_rotations(database: PoseDatabase) -> None:
    assert len(database) == SMALL.count
    np.testing.assert_allclose(np.linalg.norm(database.local_xyzw, axis=-1), 1.0, atol=1e-5)
    np.testing.assert_allclose(
        np.linalg.norm(database.camera_from_root_xyzw, axis=-1), 1.0, atol=1e-5
    )
    assert len(np.unique(database.local_xyzw.reshape(SMALL.count, -1), axis=0)) == SMALL.count


def test_a_database_map_is_its_own_nearest(database: PoseDatabase) -> None:
    for i in (0, 400, 1499):
        indices, distances = database.nearest(id_map(database, i))
        assert indices[0] == i
        assert distances[0] == 0.0
        assert (np.diff(distances) >= 0.0).all()


def test_the_index_finds_what_the_whole_search_finds(database: PoseDatabase) -> None:
    shared = []
    for i in range(0, 1500, 50):
        query = np.roll(id_map(database, i), (1, 2), axis=(0, 1))
        quick, _ = database.nearest(query, 10, probes=10, reranked=100)
        exact, _ = database.nearest(query, 10, probes=24, reranked=1500)
        shared.append(len(set(quick.tolist()) & set(exact.tolist())) / 10)
    assert np.mean(shared) > 0.9


def test_a_map_crops_to_itself(database: PoseDatabase) -> None:
    """Query and database are cut out alike: a database map drawn large is found again."""
    found = 0
    for i in range(0, 1500, 100):
        large = np.kron(np.pad(id_map(database, i), 10), np.ones((4, 4), np.uint8)).astype(np.uint8)
        indices, _ = database.nearest(crop_id_map(large)[0], 3)
        found += i in indices
    assert found >= 14


def test_nothing_has_no_neighbour(database: PoseDatabase) -> None:
    indices, distances = database.nearest(np.zeros((40, 40), np.uint8))
    assert len(indices) == len(distances) == 0


def test_blend_of_one_pose_is_that_pose_and_of_two_lies_between(database: PoseDatabase) -> None:
    local, root = database.blend(np.array([7]), np.array([3.0]))
    assert rotations.angle_rad(local, database.local_xyzw[7].astype(float)).max() < 1e-3
    assert rotations.angle_rad(root, database.camera_from_root_xyzw[7].astype(float)) < 1e-3
    near, _ = database.nearest(id_map(database, 7), 2)
    local, _ = database.blend(near, np.array([1.0, 1.0]))
    a, b = database.local_xyzw[near].astype(float)
    apart = rotations.angle_rad(a, b)
    assert (rotations.angle_rad(local, a) <= apart + 1e-3).all()
    assert (rotations.angle_rad(local, b) <= apart + 1e-3).all()


def test_half_the_size_is_twice_the_distance(database: PoseDatabase) -> None:
    one = np.array([5]), np.array([1.0])
    side = float(database.side_rad[5])
    near, far = database.root_in_view(*one, side), database.root_in_view(*one, 0.5 * side)
    assert near[2] == pytest.approx(database.root_m[5, 2])
    assert far[2] == pytest.approx(2 * near[2])


def test_camera_from_view_points_the_axis_at_the_pixel() -> None:
    K = np.array([[600.0, 0, 320], [0, 600, 240], [0, 0, 1]])
    camera = Camera("a", (640, 480), K, np.zeros(5), np.eye(3), np.zeros(3))
    turn = camera_from_view(camera, np.array([500.0, 120.0]))
    axis = rotations.rotate(turn, np.array([0.0, 0.0, 1.0]))
    np.testing.assert_allclose(project(camera, axis), [320 + 180, 240 - 120], atol=1e-9)


def test_poses_stay_within_the_joint_limits() -> None:
    poses = poses_from_cube(random_cube(2000, 1), SamplingParams())
    limits = upper_body().limits
    slack = np.radians(SamplingParams().limit_slack_deg + 0.1)
    assert len(poses) > 1700
    for g in range(len(upper_body().groups)):
        if limits.axis[g] < 0:
            continue
        q = poses.local_xyzw[:, limits.joint[g]].astype(float)
        angles = swing_twist(q, int(limits.axis[g])) / limits.share[limits.joint[g]]
        assert (angles > limits.lower_rad[g] - slack).all()
        assert (angles < limits.upper_rad[g] + slack).all()


def test_the_hash_follows_the_parameters() -> None:
    assert content_hash(SMALL) == content_hash(replace(SMALL))
    assert content_hash(SMALL) != content_hash(replace(SMALL, distance_m=3.0))
    assert content_hash(SMALL) != content_hash(
        replace(SMALL, sampling=SamplingParams(jitter_deg=5.0))
    )


def test_the_file_gives_back_what_was_written(database: PoseDatabase, tmp_path: Path) -> None:
    write_database(tmp_path / CACHE_NAME, database, content_hash(SMALL))
    loaded = load_or_build(tmp_path, SMALL)
    assert not loaded.built
    assert loaded.reason == loaded.warning == ""
    np.testing.assert_array_equal(loaded.database.local_xyzw, database.local_xyzw)
    query = np.roll(id_map(database, 3), 1, axis=0)
    for a, b in zip(loaded.database.nearest(query), database.nearest(query), strict=True):
        np.testing.assert_array_equal(a, b)
    assert [path.name for path in tmp_path.iterdir()] == [CACHE_NAME]


def test_a_twentieth_of_the_poses_serves_until_the_whole_is_made(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    tiny = DatabaseParams(count=60, cells=4, dimensions=8)
    monkeypatch.setattr(database_file, "BEGINNING", replace(tiny, count=20))
    (tmp_path / CACHE_NAME).write_bytes(b"the whole one of a former version")
    assert len(load_or_build_beginning(tmp_path).database) == 20
    assert not load_or_build_beginning(tmp_path).built
    monkeypatch.setattr(database_file, "DatabaseParams", lambda: tiny)
    assert len(load_or_build(tmp_path).database) == 60
    assert len(load_or_build_beginning(tmp_path).database) == 60
    assert BEGINNING_NAME not in {path.name for path in tmp_path.iterdir()}


@pytest.mark.parametrize("damage", ["version", "cut", "header", "flipped", "empty"])
def test_an_unusable_file_is_rebuilt_and_the_reason_told(
    database: PoseDatabase, tmp_path: Path, damage: str
) -> None:
    tiny = DatabaseParams(count=60, cells=4, dimensions=8)
    path = tmp_path / CACHE_NAME
    write_database(
        path, database, "of another version" if damage == "version" else content_hash(tiny)
    )
    data = bytearray(path.read_bytes())
    if damage == "cut":
        data = data[: len(data) // 2]
    elif damage == "header":
        data[40:60] = b"#" * 20
    elif damage == "flipped":
        data[-100] ^= 1
    elif damage == "empty":
        data = bytearray()
    path.write_bytes(data)
    loaded = load_or_build(tmp_path, tiny)
    assert loaded.built
    assert CACHE_NAME in loaded.reason
    assert len(loaded.database) == 60
    assert not load_or_build(tmp_path, tiny).built


class _BuiltAnew(Exception):
    pass


def _begin_to_build(*_parts: object) -> NoReturn:
    raise _BuiltAnew


def test_any_changed_byte_is_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The header was in no checksum: 1,137 of 5,001 changed files were tracebacks at each start."""
    tiny = DatabaseParams(count=60, cells=4, dimensions=8)
    load_or_build(tmp_path, tiny)
    path = tmp_path / CACHE_NAME
    whole = path.read_bytes()
    wanted = content_hash(tiny)  # which takes longer than all else here
    monkeypatch.setattr(database_file, "content_hash", lambda _: wanted)
    monkeypatch.setattr(database_file, "build_database", _begin_to_build)
    header = whole.index(b"}]}")
    rng = random.Random(8)
    places = [rng.randrange(header + 100) for _ in range(200)]
    places += [rng.randrange(len(whole)) for _ in range(50)]
    for place in places:
        data = bytearray(whole)
        data[place] ^= rng.randrange(1, 256)
        path.write_bytes(data)
        with pytest.raises(_BuiltAnew):
            load_or_build(tmp_path, tiny)
    path.write_bytes(whole)
    assert not load_or_build(tmp_path, tiny).built


def test_a_link_in_place_of_the_lock_leads_nowhere(tmp_path: Path) -> None:
    tiny = DatabaseParams(count=60, cells=4, dimensions=8)
    (tmp_path / "theirs").write_text("kept")
    (tmp_path / "cache").mkdir()
    (tmp_path / "cache" / LOCK_NAME).symlink_to(tmp_path / "theirs")
    assert load_or_build(tmp_path / "cache", tiny).built
    assert (tmp_path / "theirs").read_text() == "kept"


def test_of_two_who_need_it_at_once_one_makes_it(tmp_path: Path) -> None:
    tiny = DatabaseParams(count=60, cells=4, dimensions=8)
    second_waits = threading.Event()
    with ThreadPoolExecutor(2) as pool:

        def slowly(function, parts):  # type: ignore[no-untyped-def]
            second_waits.wait(30.0)
            return map(function, parts)

        first = pool.submit(load_or_build, tmp_path, tiny, map_chunks=slowly)
        while not (tmp_path / LOCK_NAME).exists():
            time.sleep(0.01)
        second = pool.submit(load_or_build, tmp_path, tiny)
        second_waits.set()
        assert sorted([first.result().built, second.result().built]) == [False, True]


def test_a_cache_that_cannot_be_written(tmp_path: Path) -> None:
    tiny = DatabaseParams(count=60, cells=4, dimensions=8)
    blocked = tmp_path / "a file, not a folder"
    blocked.write_text("")
    loaded = load_or_build(blocked / "cache", tiny)
    assert loaded.built
    assert "cache" in loaded.warning
    assert len(loaded.database.nearest(id_map(loaded.database, 0))[0]) == 10
    with pytest.raises(CannotCreateError, match="cache"):
        load_or_build(blocked / "cache", tiny, must_cache=True)


def test_the_same_parameters_build_the_same_database(database: PoseDatabase) -> None:
    def backwards(function, parts):  # type: ignore[no-untyped-def]
        return [function(part) for part in reversed(list(parts))]

    again = build_database(SMALL, map_chunks=backwards)
    np.testing.assert_array_equal(again.local_xyzw, database.local_xyzw)
    np.testing.assert_array_equal(again.index.packed_maps, database.index.packed_maps)


def test_progress_reaches_the_end() -> None:
    seen: list[float] = []
    build_database(DatabaseParams(count=60, cells=4, dimensions=8), seen.append)
    assert seen == sorted(seen)
    assert seen[-1] == 1.0
