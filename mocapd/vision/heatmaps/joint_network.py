"""Heatmaps of a person's joints in a small picture of it, and which pixels are the person, by a convolutional network.

One map a joint, as Tompson et al. 2014 (Joint training of a convolutional network and a graphical model for human pose
estimation), read by its moments (Sun et al. 2018, Integral human pose regression); and how much farther away than the hips
each joint is, with the scale of a Laplace distribution. It was trained on pictures of the simulator alone, of random people
in random clothes, rooms and lights (`lab/training/` in the checkout).
"""

from dataclasses import dataclass

import cv2
import numpy as np

from mocapd.assets import asset_path
from mocapd.types import Bytes, Floats, Singles

# In the order of the maps. Left and right of a joint are neighbours
BODY_JOINTS = (
    "head", "neck", "hips", "leftUpperArm", "rightUpperArm", "leftLowerArm", "rightLowerArm", "leftHand", "rightHand",
    "leftUpperLeg", "rightUpperLeg", "leftLowerLeg", "rightLowerLeg", "leftFoot", "rightFoot",
)  # fmt: skip
JOINTS = (*BODY_JOINTS, "leftToes", "rightToes")
INPUT_PX = 96
CELLS = 24  # of a map, each way
STATURE_M = 1.75  # of a person, to which all sizes are brought
SIDE_M = 2.4  # of what the input shows, at the distance of the body
MIDDLE = 0.3  # of the way from hips to neck, which is in the middle of the input
_FILE = "joint_heatmaps.onnx"
# Where it marks each joint, from the joint in the frame of its bone, of the left side [statures]: what it learned is held by
# flesh, which turns otherwise than bones, and means of maps fall short of the ends of limbs.
# Means of what this printed with the seeds 7 and 8: python -m lab.training.keypoint_marks CLIPS --pictures 3600
_MARKS = {
    "head": (0.0, 0.0009, 0.0009), "neck": (0.0, -0.0002, 0.0017), "hips": (0.0, -0.0005, 0.0004),
    "UpperArm": (0.0006, -0.0030, 0.0000), "LowerArm": (0.0003, -0.0014, 0.0104), "Hand": (-0.0174, -0.0012, 0.0004),
    "UpperLeg": (-0.0034, -0.0016, 0.0021), "LowerLeg": (0.0009, -0.0026, -0.0038), "Foot": (-0.0011, 0.0041, 0.0065),
    "Toes": (0.0005, 0.0054, -0.0083),
}  # fmt: skip


def _marks() -> Floats:
    out = np.empty((len(JOINTS), 3))
    for j, name in enumerate(JOINTS):
        bone = name.removeprefix("left").removeprefix("right")
        out[j] = _MARKS[bone]
        if name.startswith("right"):
            out[j, 0] *= -1.0
    return out


MARKS = _marks()  # (J,3) of JOINTS


@dataclass(frozen=True, slots=True, eq=False)
class DetectedJoints:
    """The joints of one picture, and where the person is.

    at_cells (J,2): mean x, y of each map, the middle of the first cell being 0; spread_cells2 (J,3): its variances xx, xy,
    yy; farther_m (J,): than the hips, for a stature of 1.75 m, with the scale_m (J,) of its Laplace distribution; mask_odds
    (96,96): logarithms of the odds that a pixel is the person.
    """

    at_cells: Floats
    spread_cells2: Floats
    farther_m: Floats
    scale_m: Floats
    mask_odds: Singles

    @property
    def of_body(self) -> "DetectedJoints":
        """Of `BODY_JOINTS` alone."""
        n = len(BODY_JOINTS)
        return DetectedJoints(
            self.at_cells[:n], self.spread_cells2[:n], self.farther_m[:n], self.scale_m[:n], self.mask_odds
        )  # fmt: skip


class JointNetwork:
    """The network with buffers of its own; used by one thread."""

    def __init__(self) -> None:
        """Read the trained network that comes with mocapd."""
        # imported here: numba takes half a second, which who makes no network need not wait for
        from mocapd.vision.heatmaps.heatmap_kernels import fill_input, read_maps

        self._fill_input, self._read_maps = fill_input, read_maps
        # OpenCV's newer engine takes no less time for a network this small
        self._net = cv2.dnn.readNetFromONNX(str(asset_path(_FILE)), cv2.dnn.ENGINE_CLASSIC)
        self._input = np.zeros((1, 4, INPUT_PX, INPUT_PX), np.float32)

    def detect(self, picture: Bytes, background: Singles, valid: Bytes) -> DetectedJoints:
        """Joints in a picture (96,96,3) of a person; background (96,96,3): the empty room, where `valid` (96,96) is not 0."""
        self._fill_input(picture, background, valid, self._input[0])
        self._net.setInput(self._input)
        maps, mask = self._net.forward(["maps", "mask"])
        n = len(JOINTS)
        out = np.empty((n, 7))
        self._read_maps(np.ascontiguousarray(maps[0]), n, out)
        return DetectedJoints(
            out[:, :2].copy(), out[:, 2:5].copy(), out[:, 5].copy(), out[:, 6].copy(), mask[0, 0].copy()
        )  # fmt: skip
