"""Keypoint term: each joint near the ray through its keypoint, at the network's depth relative to the hips, and each foot
turned as its keypoints are.

A shoe has few pixels, and a straight leg looks the same however it is turned about its length: silhouettes hardly say where
a foot points. Rays with an outlier's weight do not turn one that points the wrong way; the direction between ankle and toes
where rays cross does, wherever the foot stands.
"""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from mocapd.body.arrays import PosedJoints, plain
from mocapd.body.model import BodyModel, Shaped
from mocapd.body.pose_space import SIDES
from mocapd.body.skeleton import INDEX, N_JOINTS
from mocapd.fit.terms.joint_rows_kernels import pull_at_joints, turn_level
from mocapd.geometry.camera_model import from_camera, to_camera
from mocapd.types import Camera, Floats, Ints

_NOWHERE = 1e-6 * np.eye(3)  # information of a joint that no camera saw [1/m^2]
_DEEPER = 0.5  # share of an error along the ray: keypoints know depths half as well as places
_HEAD = [INDEX["head"], INDEX["neck"]]
_ANKLES, _TOES = ([INDEX[side + bone] for side in SIDES] for bone in ("Foot", "Toes"))
_TRUNK = [(INDEX["left" + j], INDEX["right" + j]) for j in ("UpperArm", "UpperLeg")]


@dataclass(frozen=True, slots=True)
class JointTermParams:
    """Weights of the keypoints. Their errors are correlated between neighbouring cameras and in time."""

    weight: float = 4.0  # of a squared Mahalanobis distance across the ray [disagreeing pixels]
    robust: float = 3.0  # standard deviations at which a joint has a quarter of its weight
    depth_weight: float = 2.0  # the same of a depth
    heading_information: float = 5000.0  # of toes beside their ankle [disagreeing pixels/m^2]
    heading_sd_m: float = 0.12  # of both, at most: adjacent cameras hardly see depth

    def weighing(self, share: float) -> "JointTermParams":
        """The same with this share of the weight."""
        return replace(
            self,
            weight=share * self.weight,
            depth_weight=share * self.depth_weight,
            heading_information=share * self.heading_information,
        )


@dataclass(frozen=True, slots=True, eq=False)
class JointRays:
    """One camera's keypoints of joints (J,), at the frame set's own instant.

    xy (J,2): undistorted normalised coordinates, with information (J,3) xx, xy, yy [1/m^2] across the ray; farther_m (J,):
    than the hips along the camera's axis, with depth_information (J,) [1/m^2].
    """

    camera: Camera
    joints: Ints
    xy: Floats
    information: Floats
    farther_m: Floats
    depth_information: Floats

    @property
    def squares(self) -> tuple[Floats, Floats, Floats]:
        """A (N,3,3), b (N,3), c (N,): the squared distance of a place x [m, world] from each ray, in its standard deviations,
        is x' A x - 2 b' x + c."""
        R, t_m, (xx, xy, yy) = self.camera.R, self.camera.t_m, self.information.T
        rows, offsets = R[:2] - self.xy[:, :, None] * R[2], self.xy * t_m[2] - t_m[:2]
        information = np.stack([np.stack([xx, xy], -1), np.stack([xy, yy], -1)], -2)
        weighted = information @ rows
        b = (weighted.swapaxes(1, 2) @ offsets[:, :, None])[:, :, 0]
        c = ((information @ offsets[:, :, None])[:, :, 0] * offsets).sum(1)
        return rows.swapaxes(1, 2) @ weighted, b, c

    def of(self, joints: Collection[int]) -> "JointRays":
        """Those of these joints."""
        is_one = np.isin(self.joints, list(joints))
        return JointRays(
            self.camera, self.joints[is_one], self.xy[is_one], self.information[is_one], self.farther_m[is_one],
            self.depth_information[is_one],
        )  # fmt: skip


class JointTerm:
    """All cameras' keypoints of one body in one frame set, a `Term`."""

    is_measured = False

    def __init__(
        self, model: BodyModel, rays: Sequence[JointRays], params: JointTermParams | None = None
    ) -> None:
        self._model, self.rays = model, rays
        self._params = params if params is not None else JointTermParams()

    @property
    def trusting(self) -> "JointTerm":
        """The same without outlier rejection, for a distant pose."""
        return JointTerm(self._model, self.rays, replace(self._params, robust=1e6))

    def depths(self, model: BodyModel, joints: Collection[int], weight: float) -> "JointTerm":
        """The depths alone of these joints, as a term of `model`."""
        params = replace(self._params, weight=0.0, depth_weight=weight)
        return JointTerm(model, [rays.of(joints) for rays in self.rays], params)

    def costs(self, joints_m: Floats) -> Floats:
        """Cost of each joint (J,) of a body at joints_m (J,3)."""
        p, out = self._params, np.zeros(len(joints_m))
        for rays in self.rays:
            place2, depth2 = _mahalanobis2(rays, joints_m)
            for m2, weight in ((place2, p.weight), (depth2, p.depth_weight)):
                out[rays.joints] += weight * m2 / (1.0 + m2 / p.robust**2)
        return out

    def off_keypoints_m(self, joints_m: Floats) -> Floats:
        """How far each joint (J,) of a body at joints_m (J,3) is from its keypoint [m], in the camera where that is largest:
        beside the ray, and a share of the distance along it; 0 without keypoints."""
        out = np.zeros(len(joints_m))
        for rays in self.rays:
            beside_m, deeper_m = _off_keypoints_m(rays, joints_m)
            off_m = np.hypot(np.linalg.norm(beside_m, axis=1), _DEEPER * deeper_m)
            out[rays.joints] = np.maximum(out[rays.joints], off_m)
        return out

    def worst_off_sds2(self, joints_m: Floats) -> float:
        """Of a body at joints_m (J,3), the median squared Mahalanobis distance of its joints from their rays, in the camera
        where that is largest, of those that show joints; 0 if none does."""
        return max(
            (
                float(np.median(_mahalanobis2(rays, joints_m)[0]))
                for rays in self.rays
                if len(rays.joints)
            ),
            default=0.0,
        )

    def median_spreads_m(self, least_joints: int) -> list[float]:
        """Of each camera, the median over its joints of the standard deviation of their places across the ray [m]; inf with
        fewer than least_joints keypoints."""
        return [
            float(np.median(_spreads_m(rays))) if len(rays.joints) >= least_joints else np.inf
            for rays in self.rays
        ]

    def head_spreads_m(self, least_joints: int) -> list[float]:
        """The same of head and neck, their mean; inf without both, too."""
        out = []
        for rays in self.rays:
            spreads_m = _spreads_m(rays)[np.isin(rays.joints, _HEAD)]
            is_known = len(rays.joints) >= least_joints and len(spreads_m) == len(_HEAD)
            out.append(float(spreads_m.mean()) if is_known else np.inf)
        return out

    def cameras_sure_of(self, joints: Sequence[int], most_m: float) -> Ints:
        """Of each joint, in how many cameras its keypoint is known to most_m [m] across the ray, by standard deviation."""
        sure = np.zeros(N_JOINTS, np.int64)
        for rays in self.rays:
            sure[rays.joints] += _spreads_m(rays) <= most_m
        return sure[list(joints)]

    def places_m(self, hips_m: Floats) -> Floats:
        """Keypoint places (J,3) of a body with its hips at hips_m (3,), averaged over the cameras; NaN without one."""
        total, count = np.zeros((N_JOINTS, 3)), np.zeros(N_JOINTS)
        for rays in self.rays:
            z = to_camera(rays.camera, hips_m[None])[0, 2] + rays.farther_m
            directions = np.concatenate([rays.xy, np.ones((len(z), 1))], axis=1)
            total[rays.joints] += from_camera(rays.camera, directions * z[:, None])
            count[rays.joints] += 1.0
        out: Floats = (
            np.where(count > 0.0, 1.0, np.nan)[:, None] * total / np.maximum(count, 1.0)[:, None]
        )
        return out

    @cached_property
    def crossings(self) -> tuple[Floats, Floats]:
        """Where the cameras' rays cross at each joint (J,3) [m, world], by weighted linear least squares, and the largest
        standard deviation (J,) of that [m]: inf where fewer than two cameras saw it."""
        A, b = np.tile(_NOWHERE, (N_JOINTS, 1, 1)), np.zeros((N_JOINTS, 3))
        cameras = np.zeros(N_JOINTS)
        for one in self.rays:
            one_A, one_b, _ = one.squares
            A[one.joints] += one_A
            b[one.joints] += one_b
            cameras[one.joints] += 1.0
        sd_m = np.where(cameras > 1.0, np.linalg.eigvalsh(A)[:, 0] ** -0.5, np.inf)
        places_m: Floats = np.asarray(np.linalg.solve(A, b[:, :, None])[:, :, 0], dtype=np.float64)
        return places_m, np.asarray(sd_m, dtype=np.float64)

    def turn_rad(self, joints_m: Floats) -> float:
        """Rotation about the vertical from a body at joints_m (J,3) to the keypoints' facing; 0 without keypoints of both
        sides of the trunk."""
        there_m = self.places_m(joints_m[0])
        measured, mine = np.zeros(3), np.zeros(3)
        for left, right in _TRUNK:
            across = there_m[left] - there_m[right]
            if np.isfinite(across).all():
                measured += across
                mine += joints_m[left] - joints_m[right]
        turn = np.arctan2(mine[2], mine[0]) - np.arctan2(measured[2], measured[0])
        return float(np.remainder(turn + np.pi, 2.0 * np.pi) - np.pi) if measured.any() else 0.0

    def add(self, posed: PosedJoints, _: Shaped, H: Floats, b: Floats, /) -> float:
        """See `Term`."""
        m, p = self._model, self._params
        cost = 0.0
        for rays in self.rays:
            cost += pull_at_joints(
                rays.joints, rays.xy, rays.information, rays.farther_m, rays.depth_information,
                (p.weight, p.robust, p.depth_weight), rays.camera.R, rays.camera.t_m, plain(m.articulation),
                plain(posed), H, b,
            )  # fmt: skip
        if len(self.rays) > 1:  # of one camera, none cross
            ankles, toes, apart_m = self._feet
            cost += turn_level(
                ankles,
                toes,
                apart_m,
                p.heading_information,
                plain(m.articulation),
                plain(posed),
                H,
                b,
            )
        return cost

    @cached_property
    def _feet(self) -> tuple[Ints, Ints, Floats]:
        """Ankles (F,) and toes (F,) of the feet whose heading is known, and the vector (F,3) between them [m, world]."""
        places_m, sd_m = self.crossings
        known = np.maximum(sd_m[_ANKLES], sd_m[_TOES]) <= self._params.heading_sd_m
        ankles, toes = np.array(_ANKLES)[known], np.array(_TOES)[known]
        apart_m, rest_m = places_m[toes] - places_m[ankles], self._model.rest_m
        length_m = np.linalg.norm(rest_m[toes] - rest_m[ankles], axis=1)
        apart_m *= (length_m / np.maximum(np.linalg.norm(apart_m, axis=1), 1e-6))[:, None]
        return ankles, toes, apart_m


def _spreads_m(rays: JointRays) -> Floats:
    """Standard deviation (J,) of each joint's place across the ray [m]."""
    xx, xy, yy = rays.information.T
    return np.asarray(np.sqrt(0.5 * (xx + yy) / (xx * yy - xy * xy)))


def _mahalanobis2(rays: JointRays, joints_m: Floats) -> tuple[Floats, Floats]:
    """Of each keypoint (N,), squared: of its place across the ray, and of its depth relative to the hips."""
    off, deeper_m = _off_keypoints_m(rays, joints_m)
    xx, xy, yy = rays.information.T
    place2 = xx * off[:, 0] ** 2 + 2.0 * xy * off[:, 0] * off[:, 1] + yy * off[:, 1] ** 2
    return place2, rays.depth_information * deeper_m**2


def _off_keypoints_m(rays: JointRays, joints_m: Floats) -> tuple[Floats, Floats]:
    """From the joints to each keypoint: across the ray (N,2), and along the camera's axis (N,) relative to the hips."""
    there = to_camera(rays.camera, joints_m)
    z = there[rays.joints, 2]
    beside_m: Floats = rays.xy * z[:, None] - there[rays.joints, :2]
    return beside_m, rays.farther_m - (z - there[0, 2])
