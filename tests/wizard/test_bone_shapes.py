"""The body over a picture: only what is known of it, and as wide as it is uncertain."""

from dataclasses import replace

import numpy as np
import pytest

from mocapd.body.skeleton import INDEX
from mocapd.geometry.camera_model import project
from mocapd.types import BodyState
from mocapd.wizard.bone_shapes import bone_shapes
from tests.geometry.rigs import ring
from tests.outputs.frames import left_hand_up

CAMERA = ring(1)[0]
BODY, SKELETON = left_hand_up()
HAND, ELBOW = INDEX["leftHand"], INDEX["leftLowerArm"]


def body(confidence: float = 1.0, uncertainty_m: float = 0.01) -> BodyState:
    n = len(SKELETON.names)
    return replace(BODY, confidence=np.full(n, confidence), uncertainty_m=np.full(n, uncertainty_m))


def without(one: BodyState, *joints: str) -> BodyState:
    """The same, with nothing known of these."""
    confidence, uncertainty_m = one.confidence.copy(), one.uncertainty_m.copy()
    unknown = [INDEX[name] for name in joints]
    confidence[unknown], uncertainty_m[unknown] = 0.0, np.inf
    return replace(one, confidence=confidence, uncertainty_m=uncertainty_m)


def test_a_bone_has_a_line_unless_nothing_is_known_of_an_end() -> None:
    lines = [shape for shape in bone_shapes(CAMERA, body(), SKELETON) if shape.kind == "line"]
    assert len(lines) == len(SKELETON.names) - 1
    less = bone_shapes(CAMERA, without(body(), "leftLowerLeg"), SKELETON)
    drawn = [shape.at_px for shape in less if shape.kind == "line"]
    assert len(drawn) == len(lines) - 2, "the thigh and the shin"
    assert BODY.joints_m is not None
    knee_px = project(CAMERA, BODY.joints_m[INDEX["leftLowerLeg"]])
    ends_px = np.array(drawn).reshape(-1, 2)
    assert np.linalg.norm(ends_px - knee_px, axis=1).min() > 20.0
    assert bone_shapes(CAMERA, body(confidence=0.0, uncertainty_m=np.inf), SKELETON) == ()


def test_an_arm_that_no_picture_shows_is_a_guess_with_its_halo() -> None:
    hidden = body()
    hidden.confidence[[ELBOW, HAND]] = 0.0
    hidden.uncertainty_m[[ELBOW, HAND]] = 0.2
    shapes = bone_shapes(CAMERA, hidden, SKELETON)
    lines = [shape for shape in shapes if shape.kind == "line"]
    assert len(lines) == len(SKELETON.names) - 1
    assert any(line.style == "hint" for line in lines)
    assert any(shape.kind == "halo" and shape.style == "hint" for shape in shapes)


def test_a_halo_is_one_standard_deviation_wide_at_the_joints_distance() -> None:
    near = body(uncertainty_m=0.04)
    (halo,) = (shape for shape in bone_shapes(CAMERA, near, SKELETON) if shape.kind == "halo")
    assert BODY.joints_m is not None
    hand_m = BODY.joints_m[HAND]
    hand_px = project(CAMERA, hand_m)
    at = int(np.linalg.norm(np.array(halo.at_px) - hand_px, axis=1).argmin())
    across_m = CAMERA.R[0]  # the camera's x axis in the world
    wide_px = np.linalg.norm(project(CAMERA, hand_m + 0.04 * across_m) - hand_px)
    assert halo.radii_px[at] == pytest.approx(wide_px, rel=0.1)
    assert len(halo.radii_px) == len(halo.at_px) == 2 * (len(SKELETON.names) - 1)


def test_what_is_guessed_has_a_halo_of_its_own_and_what_is_unknown_none() -> None:
    one = body()
    one.confidence[[ELBOW, HAND]] = 0.2
    shapes = bone_shapes(CAMERA, one, SKELETON)
    assert {shape.style for shape in shapes if shape.kind == "halo"} == {"bone", "hint"}
    assert [shape.kind for shape in shapes[:2]] == ["halo", "halo"], "below the lines"
    assert all(
        shape.kind == "line" for shape in bone_shapes(CAMERA, body(uncertainty_m=np.inf), SKELETON)
    )
