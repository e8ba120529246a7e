"""Skin colour model of one camera: learned at the face, to separate skin from the shirt's colours.

In some light skin has the shirt's pink or orange, and face and hands touch the sleeves: only a model of this wearer's
skin in the present light separates them. Trousers, tried likewise, helped in some sessions and harmed in others.
"""

import cv2
import numpy as np
from numpy.typing import NDArray

from mocapd.body.arrays import PosedJoints
from mocapd.body.skeleton import INDEX
from mocapd.geometry.camera_model import project
from mocapd.shirt.segmentation import shirt_appearance
from mocapd.shirt.segmentation.shirt_appearance import ShirtAppearance
from mocapd.types import Bytes, Camera, Floats, Singles

Disc = tuple[float, float, float]  # x, y, radius [work px]

_FACE = np.array([0.0, 0.05, 0.04])  # of the stature, from the head's joint, up and forwards
_FACING = -0.1  # cosine; a face that is turned farther away shows hair
_RADIUS = 0.025  # of the stature
_LEAST_PX = 6
_LEAST_SHARE = 0.4  # of the disc that can be skin
_LEAST_SUM_PX = 30.0  # of a valid model
_RED = (0.36, 0.62)  # share of red, and of green, of skin in white-balanced light
_GREEN = (0.22, 0.36)
_DARK = 0.08  # brightness below which shares mean nothing, 0..1
_HAND_PX = (4, 400)  # of work pictures; one that is spread out at 1.5 m takes 400
NOWHERE: Singles = np.zeros((3, 4), np.float32)  # an affine that no pixel is near to
NOWHERE[0, 3] = 1e4


def face_disc(
    camera: Camera, posed: PosedJoints, stature_m: float, image_scale: int
) -> Disc | None:
    """The middle of the face; None when the camera does not see it."""
    head = INDEX["head"]
    face_m = posed.joints[head] + posed.R[head] @ (_FACE * stature_m)
    to_camera = -camera.R.T @ camera.t_m - face_m
    away_m = float(np.linalg.norm(to_camera))
    if posed.R[head][:, 2] @ to_camera < _FACING * away_m:
        return None
    x, y = ((project(camera, face_m) + 0.5) / image_scale - 0.5).tolist()
    radius = _RADIUS * stature_m * float(camera.K[0, 0]) / away_m / image_scale
    return (x, y, radius) if np.isfinite([x, y]).all() else None


def statistics(
    picture: Bytes, shirt: Bytes, origin: tuple[int, int], disc: Disc, W: Floats
) -> Floats:
    """n, b, g, r [0..1] (4,) summed over the disc's pixels of picture (H,W,3) BGR that can be skin.

    shirt (h,w): ids as drawn at `origin`, for an arm may be before the face; W (3,3): to white-balanced RGB.
    """
    x, y, radius = disc
    h, w = shirt.shape
    x0, x1 = max(round(x - radius), origin[0]), min(round(x + radius) + 1, origin[0] + w)
    y0, y1 = max(round(y - radius), origin[1]), min(round(y + radius) + 1, origin[1] + h)
    if x1 <= x0 or y1 <= y0:
        return np.zeros(4)
    free = shirt[y0 - origin[1] : y1 - origin[1], x0 - origin[0] : x1 - origin[0]] == 0
    bgr = picture[y0:y1, x0:x1][free] / 255.0
    mine = bgr[_can_be_skin(bgr[:, ::-1] @ W.T)]
    if len(mine) < max(_LEAST_PX, _LEAST_SHARE * len(bgr)):
        return np.zeros(4)
    return np.concatenate([[len(mine)], mine.sum(axis=0)])


def _can_be_skin(balanced: Floats) -> NDArray[np.bool_]:
    """Of colours RGB (N,3) in white-balanced light: people's skin differs in brightness more than in hue."""
    total = balanced.sum(axis=1)
    red, green = (balanced[:, :2] / np.maximum(total, 1e-3)[:, None]).T
    bright = total > 3.0 * _DARK
    in_hue = (red > _RED[0]) & (red < _RED[1]) & (green > _GREEN[0]) & (green < _GREEN[1])
    out: NDArray[np.bool_] = bright & in_hue
    return out


def hand_sized(bare: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Connected components of possible skin (h,w) of the size of a hand: no noise, no walls."""
    _, labels, stats, _ = cv2.connectedComponentsWithStats(bare.astype(np.uint8), connectivity=4)
    area = stats[:, cv2.CC_STAT_AREA]
    is_hand = (area >= _HAND_PX[0]) & (area <= _HAND_PX[1])
    is_hand[0] = False
    out: NDArray[np.bool_] = is_hand[labels]
    return out


def add_statistics(sums: Floats, new: Floats, dt_s: float, memory_s: float) -> Floats:
    """Decayed sums (4,) plus new statistics (4,); unchanged without pixels."""
    if new[0] == 0.0:
        return sums
    keep = float(np.exp(-dt_s / memory_s)) if sums[0] >= _LEAST_SUM_PX else 1.0
    return keep * sums + new


def whitening(sums: Floats, cloth_sd: float, noise_sd: float, shading_sd: float) -> Singles:
    """affine (3,4) for `classify`, of skin; far from every pixel while the model is invalid."""
    if sums[0] < _LEAST_SUM_PX:
        return NOWHERE
    unmeasured = ShirtAppearance(np.eye(3), np.zeros((1, 4)))
    mean, covariance = shirt_appearance.gaussians(
        unmeasured, (sums[3:0:-1] / sums[0])[None], np.zeros((1, 3, 3)), cloth_sd, noise_sd, shading_sd
    )  # fmt: skip
    affine: Singles = shirt_appearance.whitening(mean, covariance)[0]
    return affine
