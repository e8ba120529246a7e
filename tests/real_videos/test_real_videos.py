"""What is found in videos that others recorded: faces of people who sign, a man who never leaves the picture."""

from pathlib import Path

import numpy as np
import pytest

from mocapd.geometry.camera_model import centre
from mocapd.published.hecht2009.face.lbp_cascade import frontal_faces
from mocapd.vision.foreground_kernels import BACKGROUND, BEFORE
from tests.conftest import ABSENT, SHARED
from tests.real_videos.beam import CAMERAS, OTHERS, SCALE, beam_rig, beam_walk, share_inside
from tests.real_videos.signing import signing_clip

pytestmark = [pytest.mark.long, pytest.mark.kernels]

CLIPS = tuple(sorted(SHARED.glob("realvideo/intel_asl/*.mkv")))


@pytest.fixture(scope="module")
def beam(shared_dir: Path) -> Path:
    folder = shared_dir / "realvideo" / "pose2sim_SinglePerson"
    if not folder.is_dir():
        pytest.skip(ABSENT.format("realvideo/pose2sim_SinglePerson"))
    return folder


def test_the_face_of_somebody_who_signs_is_found_in_nearly_every_frame() -> None:
    if not CLIPS:
        pytest.skip(ABSENT.format("realvideo/intel_asl"))
    cascade = frontal_faces()
    clips = [signing_clip(video, cascade, 0) for video in CLIPS[::3]]
    assert np.mean([one for clip in clips for one in clip.faces]) >= 0.95
    assert np.mean([one for clip in clips for one in clip.heads]) >= 0.97


def test_the_skeleton_of_a_man_who_never_leaves_lies_inside_of_him(beam: Path) -> None:
    walk = beam_walk(beam, 0, every=5)
    assert walk.share(walk.inside) >= 0.9
    assert np.mean(list(walk.elsewhere.values())) > 0.85  # of cameras that the tracker never sees


def test_so_it_does_where_cameras_before_and_behind_track_him(beam: Path) -> None:
    """Where he stands, most cameras never see the room behind him, and he was not found."""
    walk = beam_walk(beam, 0, every=5, tracking=CAMERAS + OTHERS)
    assert walk.share(walk.inside) >= 0.9


def test_bones_beside_what_stands_before_the_room_are_not_inside(beam: Path) -> None:
    camera = beam_rig(beam).cameras[0]
    assert camera.name in CAMERAS
    w, h = camera.size_px[0] // SCALE, camera.size_px[1] // SCALE
    joints_m = np.tile([-1.0, 1.0, 0.0], (22, 1))
    shown = np.full((h, w), BEFORE, np.uint8)
    assert share_inside([camera], joints_m, [shown]) == 1.0
    shown[:] = BACKGROUND
    assert share_inside([camera], joints_m, [shown]) == 0.0
    behind = centre(camera) * np.array([2.0, 1.0, 2.0])
    shown[:] = BEFORE
    assert share_inside([camera], np.tile(behind, (22, 1)), [shown]) == 0.0
