"""What varies a capture keeps it true."""

import json
from pathlib import Path

import cv2
import numpy as np
import pytest

from lab.varied_captures import mirrored_truth, vary
from mocapd.body.skeleton import INDEX, joint_positions, standard_skeleton
from mocapd.errors import InputError
from mocapd.geometry import rotations
from mocapd.geometry.camera_model import project
from mocapd.geometry.rig_file import load_rig
from mocapd.types import Pose
from tests.geometry.rigs import ring

SKELETON = standard_skeleton(1.75)
SIZE = (64, 48)


def written(folder: Path, frames: int = 6) -> Path:
    """A capture of one camera whose pictures are brighter from left to right, and from frame to frame."""
    folder.mkdir()
    camera = ring(1)[0]
    rng = np.random.default_rng(1)
    (folder / "rig.json").write_text(
        json.dumps(
            {
                "cameras": [
                    {
                        "name": "cam0",
                        "file": "cam0.avi",
                        "size": SIZE,
                        "fps": 30.0,
                        "K": [[60.0, 0.0, 30.0], [0.0, 60.0, 25.0], [0.0, 0.0, 1.0]],
                        "dist": [0.1, -0.05, 0.01, 0.02, 0.0],
                        "R": camera.R.tolist(),
                        "t": camera.t_m.tolist(),
                        "time_offset_s": 0.0,
                    }
                ]
            }
        )
    )
    video = cv2.VideoWriter(str(folder / "cam0.avi"), cv2.VideoWriter.fourcc(*"FFV1"), 30.0, SIZE)
    for k in range(frames):
        picture = np.zeros((SIZE[1], SIZE[0], 3), np.uint8)
        picture[:, :, 1] = np.arange(SIZE[0]) + 20 * k
        video.write(picture)
    video.release()
    quats = rotations.canonical(rng.normal(size=(frames, len(SKELETON.names), 4)) + (0, 0, 0, 3))
    quats /= np.linalg.norm(quats, axis=2, keepdims=True)
    joints = [joint_positions(SKELETON, Pose(SKELETON.rest_m[0], q)) for q in quats]
    np.savez(
        folder / "truth.npz",
        names=np.array(SKELETON.names),
        times=np.arange(frames) / 30.0,
        joints=np.array(joints),
        tpose_joints=SKELETON.rest_m,
        global_quats=quats,
        visible=np.ones(frames, bool),
    )
    return folder


def test_mirrored_cameras_see_mirrored_joints_where_the_mirrored_pictures_show_them(
    tmp_path: Path,
) -> None:
    there = written(tmp_path / "a")
    vary(there, tmp_path / "b", mirrored=True, every=1)
    one, other = (load_rig(tmp_path / name / "rig.json").cameras[0] for name in "ab")
    hands = [INDEX["leftHand"], INDEX["rightHand"]]
    with np.load(there / "truth.npz") as a, np.load(tmp_path / "b" / "truth.npz") as b:
        here_px = project(one, a["joints"][0][hands])
        mirrored_px = project(other, b["joints"][0][hands[::-1]])
        # its rotations pose the mirrored person
        pose = Pose(b["joints"][0][0], b["global_quats"][0])
        assert np.abs(joint_positions(SKELETON, pose) - b["joints"][0]).max() < 1e-9
    assert mirrored_px[:, 0] == pytest.approx(SIZE[0] - 1 - here_px[:, 0])
    assert mirrored_px[:, 1] == pytest.approx(here_px[:, 1])
    pictures = [cv2.VideoCapture(str(tmp_path / name / "cam0.avi")).read()[1] for name in "ab"]
    assert np.array_equal(pictures[1], pictures[0][:, ::-1])


def test_every_second_picture_is_kept_with_its_truth(tmp_path: Path) -> None:
    there = written(tmp_path / "a")
    vary(there, tmp_path / "b", mirrored=False, every=2)
    video = cv2.VideoCapture(str(tmp_path / "b" / "cam0.avi"))
    assert [int(video.read()[1][0, 0, 1]) for _ in range(3)] == [0, 40, 80]
    assert not video.read()[0]
    assert json.loads((tmp_path / "b" / "rig.json").read_text())["cameras"][0]["fps"] == 15.0
    with np.load(there / "truth.npz") as a, np.load(tmp_path / "b" / "truth.npz") as b:
        assert np.array_equal(b["joints"], a["joints"][::2])


def test_a_mirror_of_a_mirror_is_the_same_and_a_shirt_has_none(tmp_path: Path) -> None:
    there = written(tmp_path / "a")
    with np.load(there / "truth.npz") as data:
        truth = dict(data)
    twice = mirrored_truth(mirrored_truth(truth))
    assert all(np.array_equal(twice[name], truth[name]) for name in truth)
    (there / "scribble").mkdir()
    with pytest.raises(InputError, match="not symmetric"):
        vary(there, tmp_path / "b", mirrored=True, every=1)
