"""How well each of many places of a head explains one picture."""

import numpy as np
from numpy.typing import NDArray

from mocapd.body.arrays import CameraArrays
from mocapd.kernels.decorator import kernel
from mocapd.published.hecht2009.head.head_colour_kernels import colour_bin
from mocapd.published.hecht2009.head.projection_kernels import BEHIND, pixel_of

Array = NDArray[np.float64]

_EDGE_WEIGHT = 0.5  # of a full outline, against colours that differ by one
_FULL_EDGE = 30.0  # difference of brightness of a clear edge, 0..255


@kernel
def score_heads(
    middles: Array,
    size: Array,
    inside: Array,
    outline: Array,
    camera: CameraArrays,
    picture: NDArray[np.uint8],
    odds: NDArray[np.float32],
    gain: float,
    foreground: NDArray[np.uint8],
    up: Array,
    out: Array,
) -> None:
    """Fill out (P,): colour inside less colour beside, each -1..1, and _EDGE_WEIGHT times the outline's contrast 0..1.

    middles (P,3) [m, world]; size (2,) half width and height [m]; inside (N,2), outline (M,2): samples of the unit
    disc and of the unit circle, x right and y up; picture (H,W,3) BGR; odds, gain: of the head's colours; up (2,): unit
    vector to the head's top [px]; foreground (H,W): 0 where the background shows, which counts as a colour that heads
    never have; (0,0): not known. What lies outside of the picture counts as neither.
    """
    h, w, _ = picture.shape
    K = camera[2]
    is_known = foreground.shape[0] == h and foreground.shape[1] == w
    for p in range(len(middles)):
        x, y, z = pixel_of(camera, middles[p, 0], middles[p, 1], middles[p, 2])
        if z <= BEHIND:
            out[p] = -1.0
            continue
        a, b = K[0, 0] * size[0] / z, K[1, 1] * size[1] / z
        mine = 0.0
        for i in range(len(inside)):
            u = int(np.rint(x - inside[i, 0] * a * up[1] + inside[i, 1] * b * up[0]))
            v = int(np.rint(y + inside[i, 0] * a * up[0] + inside[i, 1] * b * up[1]))
            if 0 <= u < w and 0 <= v < h:
                mine += odds[colour_bin(picture[v, u, 0], picture[v, u, 1], picture[v, u, 2], gain)]
                if is_known and foreground[v, u] == 0:
                    mine -= 1.0
        beside = edge = 0.0
        for i in range(len(outline)):
            right, top = outline[i, 0] * a, outline[i, 1] * b
            u = int(np.rint(x + 1.3 * (-right * up[1] + top * up[0])))
            v = int(np.rint(y + 1.3 * (right * up[0] + top * up[1])))
            if not (0 <= u < w and 0 <= v < h):
                continue
            beside += odds[colour_bin(picture[v, u, 0], picture[v, u, 1], picture[v, u, 2], gain)]
            if is_known and foreground[v, u] == 0:
                beside -= 1.0
            s = int(np.rint(x + 0.8 * (-right * up[1] + top * up[0])))
            t = int(np.rint(y + 0.8 * (right * up[0] + top * up[1])))
            if 0 <= s < w and 0 <= t < h:
                step = 0
                for c in range(3):
                    step += abs(int(picture[v, u, c]) - int(picture[t, s, c]))
                edge += min(1.0, step / (3.0 * _FULL_EDGE))
        out[p] = mine / len(inside) - beside / len(outline) + _EDGE_WEIGHT * edge / len(outline)


@kernel
def score_observations(
    middles: Array, means: Array, information: Array, outlier: float, out: Array
) -> None:
    """Add to out (P,) the logarithm of how likely each place (P,3) makes what was measured.

    means (O,3) [m], information (O,3,3) [1/m^2]: inverse covariances, which may leave directions open; outlier:
    share of measurements that are of something else.
    """
    for p in range(len(middles)):
        for o in range(len(means)):
            far2 = 0.0
            for i in range(3):
                for j in range(3):
                    far2 += (
                        (middles[p, i] - means[o, i])
                        * information[o, i, j]
                        * (middles[p, j] - means[o, j])
                    )
            out[p] += np.log((1.0 - outlier) * np.exp(-0.5 * far2) + outlier)
