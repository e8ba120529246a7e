"""The measurement model of a limb's particles in the pictures of all cameras [Hecht et al. 2009].

A sample that is hidden by another part or outside the picture gets the limb's median penalty of visible samples plus a
margin: less than a misplaced limb gets, more than a correct one.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mocapd.published.hecht2009.cylinders.limb_params import LimbScoreParams
from mocapd.published.hecht2009.cylinders.occlusion_kernels import OcclusionModel
from mocapd.published.hecht2009.cylinders.scoring_kernels import Sampling, score_in_view
from mocapd.published.hecht2009.cylinders.work_camera import WorkCamera
from mocapd.types import Bytes, Floats, Singles

EDGE, SURFACE = 0, 1
_VISIBLE = 0.5  # share of a limb above which its penalties enter the running mean


@dataclass(frozen=True, slots=True, eq=False)
class LimbView:
    """One camera's evidence of an instant, at work size: its place `index` among the cameras; colour (h,w,3) BGR, edges
    (h,w,3) and motion (h/4,w/4) of `vision.motion_edges`; reference (C,along,3): colours of C parts in it, NaN
    unknown; occlusion: of the same parts."""

    index: int
    camera: WorkCamera
    colour: Bytes
    edges: NDArray[np.int16]
    motion: Bytes
    reference: Singles
    occlusion: OcclusionModel


@dataclass(frozen=True, slots=True, eq=False)
class Penalties:
    """Of N particles in V views: mean (V,N,2), 0..1, over visible samples, EDGE and SURFACE; visible (V,N,2): their share."""

    mean: Floats
    visible: Floats


@dataclass(frozen=True, slots=True, eq=False)
class UsualPenalties:
    """Running means of one limb's penalties while visible: mean (cameras,2), EDGE and SURFACE; averaged_s (cameras,2): the
    averaging time so far, at most the time constant."""

    mean: Floats
    averaged_s: Floats

    @classmethod
    def initial(cls, n_cameras: int, params: LimbScoreParams) -> "UsualPenalties":
        return cls(np.tile(params.usual, (n_cameras, 1)), np.zeros((n_cameras, 2)))


def limb_penalties(
    points_m: Floats,
    radii_m: Floats,
    parts: tuple[int, int],
    views: Sequence[LimbView],
    params: LimbScoreParams,
) -> Penalties:
    """Penalties of N particles.

    points_m (N,3,3): shoulder, elbow, wrist or hip, knee, ankle [m, world]; radii_m (2,2): of both parts' ends [m]; parts:
    their places among the parts of `views`, which do not hide the limb itself.
    """
    sampling = Sampling(
        params.along,
        params.across,
        params.colour_cap,
        params.shading,
        params.hidden_by_m,
        params.occlusion,
    )
    others = ~((1 << parts[0]) | (1 << parts[1])) if params.occlusion else 0
    out = Penalties(
        np.empty((len(views), len(points_m), 2)), np.empty((len(views), len(points_m), 2))
    )
    for v, view in enumerate(views):
        reference = view.reference[list(parts)]
        score_in_view(
            points_m, radii_m, view.camera, view.colour, view.edges, reference, view.occlusion,
            others, sampling, out.mean[v], out.visible[v],
        )  # fmt: skip
    return out


def log_scores(
    penalties: Penalties, usual: UsualPenalties, views: Sequence[LimbView], params: LimbScoreParams
) -> Floats:
    """Logarithm (N,) of each particle's likelihood up to a constant, summed over the views. A view that shows
    none of them adds the same to all."""
    hidden = usual.mean[[view.index for view in views]][:, None] + params.hidden_surplus
    charged = penalties.visible * penalties.mean + (1.0 - penalties.visible) * hidden
    weight = np.array([params.edge_weight, params.surface_weight if params.appearance else 0.0])
    out: Floats = -(charged.sum(axis=0) @ weight)
    return out


def learn_usual(
    usual: UsualPenalties,
    penalties: Penalties,
    weights: Floats,
    views: Sequence[LimbView],
    dt_s: float,
    params: LimbScoreParams,
) -> UsualPenalties:
    """Running mean with the penalties of particles of these weights (N,), dt_s after the last ones; a plain mean at first.
    Unchanged if a view shows less than half of the limb."""
    mean, averaged_s = usual.mean.copy(), usual.averaged_s.copy()
    for v, view in enumerate(views):
        share = weights @ penalties.visible[v]
        now = weights @ (penalties.visible[v] * penalties.mean[v]) / np.maximum(share, 1e-9)
        gain = np.where(share > _VISIBLE, min(dt_s, params.usual_s), 0.0)
        total = np.minimum(averaged_s[view.index] + gain, params.usual_s)
        mean[view.index] += gain / np.maximum(total, 1e-9) * (now - mean[view.index])
        averaged_s[view.index] = total
    return UsualPenalties(mean, averaged_s)
