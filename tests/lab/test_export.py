"""An exported capture reads back as what was simulated."""

import json
import subprocess
import sys
from pathlib import Path

import cv2
import numpy as np
import pytest

from lab.simulated.export import export_capture
from mocapd.calibration.from_origin import from_capture
from mocapd.capture.capture_folder import frame_sets, load_folder
from mocapd.errors import CannotCreateError
from mocapd.geometry.camera_model import project
from mocapd.geometry.rig_file import load_rig
from mocapd.sim.world import World
from tests.sim.small import renderers, scenario, table

SECONDS, APPEARS_S = 1.2, 0.3


@pytest.fixture(scope="module")
def capture(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("captures") / "small"
    export_capture(scenario(person_appears_s=APPEARS_S), folder, SECONDS)
    return folder


def test_videos_hold_every_frame_as_rendered(capture: Path) -> None:
    for k in range(2):
        video = cv2.VideoCapture(str(capture / f"cam{k}.mp4"))
        frames = []
        while True:
            ok, picture = video.read()
            if not ok:
                break
            frames.append(picture)
        assert len(frames) == round(SECONDS * 30)
        # the first ones are the empty room; a lossy codec may change a value by a little
        error = np.abs(frames[20].astype(float) - renderers()[k].frame(20))
        assert error.mean() < 6.0


def test_the_rig_reads_back_with_offsets(capture: Path) -> None:
    rig = load_rig(capture / "rig.json")
    for camera, renderer in zip(rig.cameras, renderers(), strict=True):
        assert camera.name == renderer.camera.name
        assert np.allclose(camera.K, renderer.camera.K)
        assert np.allclose(camera.R, renderer.camera.R)
    entries = json.loads((capture / "rig.json").read_text())["cameras"]
    assert [entry["time_offset_s"] for entry in entries] == [0.0, 0.011]
    assert json.loads((capture / "subject.json").read_text()) == {"stature_m": 1.75}


def test_truth_is_the_world_and_absent_before_the_person_appears(capture: Path) -> None:
    truth = np.load(capture / "truth.npz", allow_pickle=False)
    visible = truth["visible"]
    assert np.array_equal(visible, truth["times"] >= APPEARS_S)
    assert np.isnan(truth["joints"][~visible]).all()
    state = World(scenario()).at(float(truth["times"][20]))
    assert np.allclose(truth["joints"][20], state.joints_m, atol=1e-5)
    assert truth["verts"].shape == (36, 500, 3)
    assert truth["tpose_verts"].shape == (500, 3)


def test_truth_points_lie_on_the_masks_and_labels_have_patches(capture: Path) -> None:
    truth = np.load(capture / "truth.npz", allow_pickle=False)
    rig = load_rig(capture / "rig.json")
    for k, camera in enumerate(rig.cameras):
        mask = cv2.imread(str(capture / "masks" / f"cam{k}_000030.png"), cv2.IMREAD_GRAYSCALE)
        label = cv2.imread(str(capture / "labels" / f"cam{k}_000030.png"), cv2.IMREAD_GRAYSCALE)
        empty = cv2.imread(str(capture / "masks" / f"cam{k}_000000.png"), cv2.IMREAD_GRAYSCALE)
        assert mask is not None
        assert label is not None
        assert empty is not None
        assert not empty.any()
        assert len(np.unique(label)) > 8
        x, y = np.round(project(camera, truth["verts"][30].astype(float))).astype(int).T
        inside = (x >= 0) & (y >= 0) & (x < 160) & (y < 120)
        grown = cv2.dilate(mask, np.ones((5, 5), np.uint8))
        assert np.mean(grown[y[inside], x[inside]] == 255) > 0.97


def test_scribbles_and_model_are_there(capture: Path) -> None:
    stems = [capture / "scribble" / f"cam{k}" for k in range(2)]
    stems += [capture / "model" / str(i) for i in range(5)]
    for stem in stems:
        picture = cv2.imread(f"{stem}.png")
        strokes = cv2.imread(f"{stem}_strokes.png", cv2.IMREAD_GRAYSCALE)
        assert picture is not None
        assert strokes is not None
        assert picture.shape[:2] == strokes.shape
        assert 1 <= len(np.unique(strokes)) - 1 <= 10


def test_the_shared_scorer_gives_a_perfect_track_a_perfect_score(
    capture: Path, shared_dir: Path, tmp_path: Path
) -> None:
    truth = np.load(capture / "truth.npz", allow_pickle=False)
    n = len(truth["times"])
    np.savez(
        tmp_path / "track.npz",
        times=truth["times"],
        joint_names=truth["names"],
        joints=truth["joints"],
        global_quats=truth["global_quats"],
        confidence=np.ones((n, 22)),
        tracker=np.array(["truth"] * n),
    )
    score = shared_dir / "tools" / "score_track.py"
    arguments = [str(score), str(capture), str(tmp_path / "track.npz"), "--skip", "0", "--json"]
    result = subprocess.run(
        [sys.executable, *arguments], capture_output=True, text=True, check=True
    )
    figures = json.loads(result.stdout)
    assert figures["rms_cm"] == pytest.approx(0.0, abs=1e-3)
    assert figures["coverage"] == 1.0
    assert figures["ghost_frames"] == 0


def test_a_directory_that_cannot_be_made_is_an_error(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(CannotCreateError, match="another directory"):
        export_capture(scenario(), tmp_path / "file" / "capture", 0.1)


def test_without_the_shirt_there_are_no_pictures_of_it_and_a_lost_camera_is_black(
    tmp_path: Path,
) -> None:
    cameras = [dict(camera) for camera in table()["cameras"]]
    cameras[1]["outages"] = [{"from_s": 0.205, "to_s": 0.405}]
    s = scenario(cameras=cameras, clothes={"shirt": "plain"}, body={"whole": True})
    export_capture(s, tmp_path / "plain", 0.5, notes={"clear_s": 0.3})
    assert not (tmp_path / "plain" / "scribble").exists()
    assert not (tmp_path / "plain" / "model").exists()
    assert from_capture(load_folder(tmp_path / "plain")).wearer.stature_m == 1.75
    info = json.loads((tmp_path / "plain" / "info.json").read_text())
    assert info["outfit"] == "plain"
    assert info["clear_s"] == 0.3
    sets = list(frame_sets(load_folder(tmp_path / "plain")))
    assert [len(one.frames) for one in sets] == [1 if 6 <= f < 12 else 2 for f in range(15)]
    bright = []
    for k in range(2):
        video = cv2.VideoCapture(str(tmp_path / "plain" / f"cam{k}.mp4"))
        bright.append([float(video.read()[1].mean()) > 10 for _ in range(15)])
    assert all(bright[0])
    # frames of the second camera are exposed 11 ms later, and so 6 is lost and 12 is there
    assert bright[1] == [not 6 <= f < 12 for f in range(15)]
    truth = np.load(tmp_path / "plain" / "truth.npz")
    assert np.isfinite(truth["joints"]).all()
    assert len(truth["names"]) == 22
