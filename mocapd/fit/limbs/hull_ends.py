"""Where an arm may reach: the far end of what the visual hull has beside the drawn body.

A part of space that the silhouettes of several cameras agree on, and that at least two of them show beside the body as drawn,
is part of a limb that is drawn elsewhere. Its end away from the shoulder is likely a hand.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from mocapd.fit.limbs.two_bone_ik import LIMBS
from mocapd.fit.solver import Fitter
from mocapd.fit.view import View
from mocapd.fit.work_size import work_size
from mocapd.geometry.camera_model import project, rays
from mocapd.types import Floats, Ints, Singles
from mocapd.vision.hull.ray_hull import carve_log_odds

_BODY, _OTHER, _BACKGROUND = 1.5, -0.5, -3.0  # log-odds of the person, by what a pixel shows
_MOST_RAYS = 100  # of a view

Mask = NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class HullEndParams:
    """What counts as an end of the hull."""

    cameras: int = 3  # least number of views
    beside_px: int = 2  # width of the margin about the drawn body [work px]
    least_px: int = 6  # of the person beside it, in each of `outside` views
    outside: int = 2  # views that show a point beside the body
    step_m: float = 0.05  # between the points that are tried
    least_points: int = 3
    reach: float = 1.15  # farthest from the shoulder, of the arm's length
    nearest: float = 0.35  # nearest, likewise
    end_m: float = 0.08  # depth of an end
    hand_m: float = 0.08  # from the wrist to the middle of an end
    # of the wrist there from the present one: a nearer end is in the fit's reach
    away_m: float = 0.10


@dataclass(frozen=True, slots=True, eq=False)
class HullViews:
    """The views of one frame set with, for each, the person's pixels beside the drawn body (h,w) and the log-odds that a
    pixel is the person's, of the whole work picture."""

    views: Sequence[View]
    beside: Sequence[Mask]
    log_odds: Sequence[Singles]


def hull_views(fitter: Fitter, views: Sequence[View], params: HullEndParams) -> HullViews | None:
    """Of the body that the fitter drew last into every view; None where too few views show the person beside it."""
    beside = [_beside_body(fitter, view, params.beside_px) for view in views]
    if sum(np.count_nonzero(mask) >= params.least_px for mask in beside) < params.outside:
        return None
    return HullViews(views, beside, [_log_odds(fitter, view) for view in views])


def rehearse_hull(fitter: Fitter) -> None:
    """Compiles or loads the hull's kernel."""
    cameras = [drawing.camera for drawing in fitter.drawings]
    carve_log_odds(cameras, [np.zeros((2, 2), np.float32) for _ in cameras], np.zeros((1, 3)))


def wrist_at_hull_end(
    fitter: Fitter, joints_m: Floats, side: str, seen: HullViews, params: HullEndParams
) -> Floats | None:
    """Place (3,) [m] of the wrist of an arm that reaches to the end of what the hull has beside the body; None without such
    an end, or where the wrist is there. joints_m (J,3): of the drawn body."""
    p, arm = params, LIMBS[f"{side}_arm"]
    shoulder, elbow, wrist = joints_m[[arm.upper, arm.lower, arm.end]]
    length_m = float(np.linalg.norm(elbow - shoulder) + np.linalg.norm(wrist - elbow))
    points, shown = _points_beside(fitter, seen, shoulder, p.reach * length_m, p)
    away_m = np.linalg.norm(points - shoulder, axis=1)
    mine = _nearest_limb(points, joints_m) == list(LIMBS).index(f"{side}_arm")
    mine &= away_m > p.nearest * length_m
    points, shown = points[mine], shown[mine]
    if len(points) < p.least_points:
        return None
    cameras = [fitter.drawings[view.index].camera for view in seen.views]
    inside = carve_log_odds(cameras, seen.log_odds, points) > 0.0
    points, shown = points[inside], shown[inside]
    if len(points) < p.least_points:
        return None
    # what fewer views show beside the body may be before or behind it
    most = np.sort(shown)[-p.least_points]
    points = points[shown >= most]
    away_m = np.linalg.norm(points - shoulder, axis=1)
    end = points[away_m > away_m.max() - p.end_m].mean(axis=0)
    along = (end - shoulder) / np.linalg.norm(end - shoulder)
    there: Floats = end - p.hand_m * along
    return there if np.linalg.norm(there - wrist) > p.away_m else None


def _beside_body(fitter: Fitter, view: View, beside_px: int) -> Mask:
    drawn = (fitter.drawings[view.index].last(view.roi)[0] > 0).astype(np.uint8)
    near = cv2.dilate(drawn, np.ones((2 * beside_px + 1,) * 2, np.uint8))
    return np.asarray((view.ids > 0) & (near == 0))


def _log_odds(fitter: Fitter, view: View) -> Singles:
    drawing = fitter.drawings[view.index]
    w, h = work_size(drawing.camera, drawing.image_scale)
    odds = np.full((h, w), _BACKGROUND, np.float32)
    x0, y0, x1, y1 = view.roi
    other = np.where(view.pixel_weight == 255, _BACKGROUND, _OTHER)
    odds[y0:y1, x0:x1] = np.where(view.ids > 0, _BODY, other)
    return odds


def _points_beside(
    fitter: Fitter, seen: HullViews, about_m: Floats, reach_m: float, p: HullEndParams
) -> tuple[Floats, Ints]:
    """Points (P,3) within reach of a place that at least `outside` views show beside the body, along rays of such pixels, and
    how many views show each (P,)."""
    order = np.argsort([-np.count_nonzero(mask) for mask in seen.beside], kind="stable")
    steps_m = np.arange(-reach_m, reach_m, p.step_m)
    out, counts = [], []
    # every point that enough views show is shown by one of these, those with the most pixels
    for k in order[: len(order) - p.outside + 1]:
        view = seen.views[k]
        drawing = fitter.drawings[view.index]
        yx = np.argwhere(seen.beside[k])
        yx = yx[:: max(1, len(yx) // _MOST_RAYS)] + (view.roi[1], view.roi[0])
        eye, ways = rays(drawing.camera, (yx[:, ::-1] + 0.5) * drawing.image_scale - 0.5)
        along_m = ((about_m - eye) @ ways.T)[:, None] + steps_m
        points = (eye + along_m[..., None] * ways[:, None]).reshape(-1, 3)
        points = points[np.linalg.norm(points - about_m, axis=1) < reach_m]
        shown = np.sum([_shows(fitter, seen, i, points) for i in range(len(seen.views))], axis=0)
        out.append(points[shown >= p.outside])
        counts.append(shown[shown >= p.outside])
    return np.concatenate(out), np.concatenate(counts)


def _shows(fitter: Fitter, seen: HullViews, k: int, points_m: Floats) -> Mask:
    """Whether a view shows points (P,3) beside the body."""
    view, beside = seen.views[k], seen.beside[k]
    drawing = fitter.drawings[view.index]
    at = (project(drawing.camera, points_m) + 0.5) / drawing.image_scale - 0.5 - view.roi[:2]
    xy = np.rint(np.nan_to_num(at, nan=-1.0)).astype(np.int64)
    inside = ((xy >= 0) & (xy < beside.shape[::-1])).all(axis=1)
    out = np.zeros(len(points_m), np.bool_)
    out[inside] = beside[xy[inside, 1], xy[inside, 0]]
    return out


def _nearest_limb(points_m: Floats, joints_m: Floats) -> Ints:
    """The limb (P,), by its place in LIMBS, whose bones are nearest to points (P,3): a foot is no hand."""
    bones = [b for one in LIMBS.values() for b in ((one.upper, one.lower), (one.lower, one.end))]
    away_m = []
    for a, b in bones:
        bone = joints_m[b] - joints_m[a]
        off = points_m - joints_m[a]
        share = np.clip(off @ bone / (bone @ bone), 0.0, 1.0)
        away_m.append(np.linalg.norm(off - share[:, None] * bone, axis=1))
    return np.asarray(np.argmin(away_m, axis=0) // 2)
