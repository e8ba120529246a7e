"""Joints that a network saw in pictures: each near the ray to where it was seen, and as much farther away than the hips."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from mocapd.body.arrays import PosedJoints
from mocapd.body.model import BodyModel
from mocapd.body.shaping import Shaped
from mocapd.body.skeleton import INDEX, N_JOINTS
from mocapd.fit.terms.joint_rows_kernels import pull_at_joints
from mocapd.geometry.camera_model import from_camera, to_camera
from mocapd.types import Camera, Floats, Ints

_TRUNK = [(INDEX["left" + j], INDEX["right" + j]) for j in ("UpperArm", "UpperLeg")]


@dataclass(frozen=True, slots=True)
class JointTermParams:
    """How much the joints count that a network saw. It errs alike in cameras beside each other, and from frame to frame."""

    weight: float = 4.0  # of a squared Mahalanobis distance [disagreeing pixels]
    robust: float = 3.0  # standard deviations at which a joint has a quarter of its weight
    depth_weight: float = 0.5  # of its depth beside its place


@dataclass(frozen=True, slots=True, eq=False)
class JointRays:
    """What one camera saw of joints (J,), at the frame set's own instant.

    xy (J,2): undistorted normalised coordinates, with information (J,3) xx, xy, yy [1/m^2] across the ray; farther_m (J,):
    than the hips along the camera's axis, with depth_information (J,) [1/m^2].
    """

    camera: Camera
    joints: Ints
    xy: Floats
    information: Floats
    farther_m: Floats
    depth_information: Floats


class JointTerm:
    """What the cameras of one frame set saw of one body's joints, a `Term`."""

    is_measured = False

    def __init__(
        self, model: BodyModel, seen: Sequence[JointRays], params: JointTermParams | None = None
    ) -> None:
        self._model, self.seen = model, seen
        self._params = params if params is not None else JointTermParams()

    @property
    def trusting(self) -> "JointTerm":
        """The same for a pose that is far away: no joint is taken for another thing."""
        return JointTerm(self._model, self.seen, replace(self._params, robust=1e6))

    def costs(self, joints_m: Floats) -> Floats:
        """What each joint (J,) of a body at joints_m (J,3) costs."""
        p, out = self._params, np.zeros(len(joints_m))
        for one in self.seen:
            place2, depth2 = _mahalanobis2(one, joints_m)
            for m2, weight in ((place2, p.weight), (depth2, p.weight * p.depth_weight)):
                out[one.joints] += weight * m2 / (1.0 + m2 / p.robust**2)
        return out

    def off_sds2(self, joints_m: Floats) -> list[Floats]:
        """Of each camera, how far off the rays its joints (N,) are in a body at joints_m (J,3) [standard deviations^2]."""
        return [_mahalanobis2(one, joints_m)[0] for one in self.seen]

    def median_spreads_m(self, least_joints: int) -> list[float]:
        """Of each camera, the median over its joints of the standard deviation of their places across the ray [m]; inf where
        it saw fewer than least_joints."""
        out: list[float] = []
        for one in self.seen:
            xx, xy, yy = one.information.T
            enough = len(one.joints) >= least_joints
            spreads_m = np.sqrt(0.5 * (xx + yy) / (xx * yy - xy * xy))
            out.append(float(np.median(spreads_m)) if enough else np.inf)
        return out

    def places_m(self, hips_m: Floats) -> Floats:
        """Where each joint (J,3) of a body with its hips at hips_m (3,) was seen, on average of the cameras; NaN: nowhere."""
        total, count = np.zeros((N_JOINTS, 3)), np.zeros(N_JOINTS)
        for one in self.seen:
            z = to_camera(one.camera, hips_m[None])[0, 2] + one.farther_m
            rays = np.concatenate([one.xy, np.ones((len(z), 1))], axis=1)
            total[one.joints] += from_camera(one.camera, rays * z[:, None])
            count[one.joints] += 1.0
        out: Floats = (
            np.where(count > 0.0, 1.0, np.nan)[:, None] * total / np.maximum(count, 1.0)[:, None]
        )
        return out

    def triangulate(self, joint: int) -> tuple[Floats, Floats]:
        """Where a joint is by the rays of all cameras: its place (3,) [m, world] and covariance (3,3) [m^2], by weighted
        linear least squares; NaN and inf where fewer than two cameras saw it."""
        A, b, cameras = np.zeros((3, 3)), np.zeros(3), 0
        for one in self.seen:
            for n in np.flatnonzero(one.joints == joint):
                R, t_m, (xx, xy, yy) = one.camera.R, one.camera.t_m, one.information[n]
                rows = R[:2] - one.xy[n, :, None] * R[2]
                weighted = rows.T @ np.array([[xx, xy], [xy, yy]])
                A += weighted @ rows
                b += weighted @ (one.xy[n] * t_m[2] - t_m[:2])
                cameras += 1
        if cameras < 2:
            return np.full(3, np.nan), np.full((3, 3), np.inf)
        covariance = np.asarray(np.linalg.inv(A))
        return covariance @ b, covariance

    def turn_rad(self, joints_m: Floats) -> float:
        """By how much a body with joints at joints_m (J,3) must turn about the vertical to face as it was seen; 0 where too
        little of its trunk was."""
        there_m = self.places_m(joints_m[0])
        seen, mine = np.zeros(3), np.zeros(3)
        for left, right in _TRUNK:
            across = there_m[left] - there_m[right]
            if np.isfinite(across).all():
                seen += across
                mine += joints_m[left] - joints_m[right]
        turn = np.arctan2(mine[2], mine[0]) - np.arctan2(seen[2], seen[0])
        return float(np.remainder(turn + np.pi, 2.0 * np.pi) - np.pi) if seen.any() else 0.0

    def add(self, posed: PosedJoints, body: Shaped, H: Floats, b: Floats) -> float:
        """See `Term`."""
        m, p = self._model, self._params
        cost = 0.0
        for one in self.seen:
            cost += pull_at_joints(
                one.joints, one.xy, one.information, one.farther_m, one.depth_information,
                (p.weight, p.robust, p.depth_weight), one.camera.R, one.camera.t_m, body.rest, m.parents,
                m.joint_of_group, m.group_of_joint, m.share_of_joint, posed.R, posed.joints, H, b,
            )  # fmt: skip
        return cost


def _mahalanobis2(seen: JointRays, joints_m: Floats) -> tuple[Floats, Floats]:
    """Of each joint that was seen (N,), squared: of its place across the ray, and of its depth beside the hips'."""
    there = to_camera(seen.camera, joints_m)
    z = there[seen.joints, 2]
    off = seen.xy * z[:, None] - there[seen.joints, :2]
    xx, xy, yy = seen.information.T
    place2 = xx * off[:, 0] ** 2 + 2.0 * xy * off[:, 0] * off[:, 1] + yy * off[:, 1] ** 2
    depth2 = seen.depth_information * (seen.farther_m - (z - there[0, 2])) ** 2
    return place2, depth2
