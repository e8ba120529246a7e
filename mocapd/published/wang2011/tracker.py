"""The tracker of [Wang 2011] as in the paper; every pose starts from the database."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from mocapd.body.areas import ARM_AREAS, TORSO_QUARTERS, Area
from mocapd.body.model import build_model
from mocapd.body.shape import BodyShape, skeleton_of
from mocapd.body.skeleton import (
    INDEX,
    N_JOINTS,
    joint_positions,
    local_from_global,
    standard_skeleton,
)
from mocapd.clock import seconds
from mocapd.geometry import rotations
from mocapd.published.wang2011.centroid_ik import CentroidSolver, Target
from mocapd.published.wang2011.covariances import load_covariances
from mocapd.published.wang2011.distance_maps import distance_maps
from mocapd.published.wang2011.drawing import (
    PatchRenderer,
    Posture,
    classified_patches,
    draw,
    posture,
)
from mocapd.published.wang2011.params import Params
from mocapd.published.wang2011.placement import blended_local, constraints, guess, place
from mocapd.published.wang2011.segmenter import Sight, Wang2011Segmenter
from mocapd.shirt.colour.colour_model import ColourModel
from mocapd.shirt.garment import shirt_labels
from mocapd.shirt.pose_database.database import PoseDatabase
from mocapd.tracking.base import (
    Probe,
    Track,
    lost_body,
    no_probe,
    require_stature,
)
from mocapd.tracking.tracking_state import TrackingState, TrackingStateParams, confidence_fade
from mocapd.types import BodyState, Bytes, Floats, FrameSet, Pose, Rig, Tracking
from mocapd.vision.raster_kernels import label_triangles

# The patches that show each joint; joints not named share the trunk's confidence.
_LEFT, _RIGHT = (tuple(Area)[ARM_AREAS[side]] for side in ("left", "right"))
_PATCHES_OF = {
    side + bone: sleeve[of_bone]
    for side, sleeve in (("left", _LEFT), ("right", _RIGHT))
    for bone, of_bone in (
        ("Shoulder", slice(0, 1)), ("UpperArm", slice(0, 3)), ("LowerArm", slice(1, 5)),
        ("Hand", slice(3, 6)),
    )
}  # fmt: skip
_FULL_SAMPLES = 40.0  # samples of a joint's patches in the best camera, for full confidence


class Wang2011Tracker:
    """Steps 1 to 5 of section 5.2 on every frame set; contract: mocapd.tracking.base.

    It does not estimate the wearer's proportions: it solves for the mean body and returns that pose on
    the given body.
    """

    name = "wang2011"

    def __init__(
        self,
        rig: Rig,
        stature_m: float,
        colour_model: ColourModel,
        white_balance: Mapping[str, Floats],
        database: PoseDatabase,
        params: Params | None = None,
        tracking: TrackingStateParams | None = None,
    ) -> None:
        """white_balance: W (3,3) per camera name, from the user's strokes; identity where missing."""
        self.params = params or Params()
        self.probe: Probe = no_probe
        self._database = database
        self._model = build_model(stature_m)
        self._colour = shirt_labels(self._model).label
        self._tracking = TrackingState(tracking)
        self._solver = CentroidSolver(self._model, load_covariances(), self.params.iterations)
        self._segmenters = {
            camera.name: Wang2011Segmenter(
                camera, colour_model, white_balance.get(camera.name, np.eye(3)), self.params
            )
            for camera in rig.cameras
        }
        self.reset()

    def reset(self, near: BodyState | None = None) -> None:
        """Forget everything learned since construction. near: the prior of the first pose."""
        for segmenter in self._segmenters.values():
            segmenter.reset()
        self._last: Posture | None = None
        self._last_t_ns = 0
        self._last_state: BodyState | None = None
        self._tracking.reset()
        if near is not None and near.pose is not None:
            local = local_from_global(
                standard_skeleton(self._model.stature_m), near.pose.quats_xyzw
            )
            self._last = posture(self._model, near.pose.root_m, local)
            self._last_t_ns, self._last_state = near.t_ns, near
            self._tracking.reset(near.t_ns)

    def step(self, frames: FrameSet, shape: BodyShape) -> Track:
        require_stature(shape, self._model.stature_m)
        sights: dict[str, Sight] = {}
        for name, segmenter in self._segmenters.items():
            if name in frames.frames:
                sight = segmenter.look(frames.frames[name].pixels)
                if sight is not None:
                    sights[name] = sight
        self.probe("classify")
        body, agreement, renderers, refined = self._pose(frames, sights)
        self.probe("pose")
        evidence = body is not None and agreement >= self.params.min_agreement
        tracking = self._tracking.step(frames.t_ns, evidence)
        if body is not None and evidence:
            for name, drawing in renderers.items():
                self._segmenters[name].learn(
                    frames.frames[name].pixels,
                    sights[name].grid,
                    drawing,
                    self._colour,
                    refined[name],
                )
            self.probe("learn")
            self._last, self._last_t_ns = body, frames.t_ns
            self._last_state = BodyState(
                t_ns=frames.t_ns,
                tracking=Tracking.LIVE,
                tracker=self.name,
                pose=Pose(body.root_m, rotations.canonical(body.turned_xyzw)),
                joints_m=body.joints_m,
                confidence=_confidence(list(renderers.values()), agreement),
                cameras=tuple(renderers),
            )
        if tracking is Tracking.LOST:
            if not evidence:
                self._forget_body()
            return Track(lost_body(frames.t_ns, self.name), shape, 0.0, *_evidence(sights))
        return self._track(tracking, frames.t_ns, shape, agreement, sights)

    def _track(
        self,
        tracking: Tracking,
        t_ns: int,
        shape: BodyShape,
        agreement: float,
        sights: Mapping[str, Sight],
    ) -> Track:
        """The last pose, of the wearer's own shape; it stays for a moment without evidence."""
        last = self._last_state
        assert last is not None
        assert last.pose is not None
        left = confidence_fade(seconds(t_ns - last.t_ns))
        live = tracking is Tracking.LIVE
        body = replace(
            last,
            t_ns=t_ns,
            tracking=tracking,
            tracker=self.name,
            joints_m=joint_positions(skeleton_of(shape), last.pose),
            confidence=last.confidence * left,
            cameras=last.cameras if live else (),
        )
        return Track(body, shape, min(1.0, agreement) if live else 0.0, *_evidence(sights))

    def _forget_body(self) -> None:
        self._last = self._last_state = None
        for segmenter in self._segmenters.values():
            segmenter.forget_body()

    def _pose(
        self, frames: FrameSet, sights: Mapping[str, Sight]
    ) -> tuple[Posture | None, float, dict[str, PatchRenderer], dict[str, Bytes]]:
        """Steps 2 to 4: the pose, the share of rendered samples classified alike, and per camera the
        rendered pose and the ids of step 3."""
        params, model = self.params, self._model
        guesses = {}
        for name, sight in sights.items():
            found = guess(self._database, self._segmenters[name].camera, sight, params.neighbours)
            if len(found.indices) and found.distances[0] <= params.max_distance_px2:
                guesses[name] = found
        if not guesses:
            return None, 0.0, {}, {}
        local = blended_local(self._database, list(guesses.values()))
        marks = [constraints(model, local, g, sights[name]) for name, g in guesses.items()]
        root_m, local[0] = place(list(guesses.values()), marks)
        blended = posture(model, root_m, local)

        targets, refined = [], {}
        for name in guesses:
            target, refined[name] = self._target(
                self._segmenters[name], frames.frames[name].pixels, sights[name], blended
            )
            targets.append(target)
        elapsed_s = (frames.t_ns - self._last_t_ns) * 1e-9
        body = self._solver.solve(targets, blended, self._last, elapsed_s, params.min_patch_samples)
        renderers = {
            name: draw(model, body, self._segmenters[name].camera, sights[name].grid)
            for name in guesses
        }
        alike = [_agreement(renderers[name], self._colour, refined[name]) for name in guesses]
        rendered = sum(n for _, n in alike)
        return body, sum(n for n, _ in alike) / max(rendered, 1), renderers, refined

    def _target(
        self, segmenter: Wang2011Segmenter, pixels: Bytes, sight: Sight, blended: Posture
    ) -> tuple[Target, Bytes]:
        """Step 3, and the centroids of its patches."""
        grid, params = sight.grid, self.params
        drawing = draw(self._model, blended, segmenter.camera, grid)
        rendered = np.empty((grid.height, grid.width), np.uint8)
        label_triangles(drawing.triangle_at, self._colour, rendered)
        # farther away than this the prior alone exceeds the threshold
        reach = params.prior_threshold / params.prior_weight * sight.size_px / grid.stride
        distance, nearest_yx = distance_maps(rendered, reach)
        ids = segmenter.refine(pixels, sight, distance) if params.pose_prior else sight.ids
        count, centroid = classified_patches(ids, nearest_yx, drawing.triangle_at, self._model.area)
        wanted = count >= params.min_patch_samples
        wanted[0] = False
        return Target(segmenter.camera, grid, grid.to_pixels(centroid), wanted), ids


def _evidence(
    sights: Mapping[str, Sight],
) -> tuple[dict[str, Bytes], dict[str, tuple[int, int, int, int]]]:
    regions = {}
    for name, sight in sights.items():
        g = sight.grid
        regions[name] = (g.x0, g.y0, g.x0 + g.width * g.stride, g.y0 + g.height * g.stride)
    return {name: sight.ids for name, sight in sights.items()}, regions


def _agreement(drawing: PatchRenderer, colour: Bytes, ids: Bytes) -> tuple[int, int]:
    """How many rendered shirt samples are classified as the same colour, and how many there are."""
    rendered = np.empty(ids.shape, np.uint8)
    label_triangles(drawing.triangle_at, colour, rendered)
    return int(((rendered == ids) & (rendered > 0)).sum()), int((rendered > 0).sum())


def _confidence(renderers: list[PatchRenderer], agreement: float) -> Floats:
    """Per joint (J,): visible samples of its patches in the best camera, times the overall agreement."""
    count = np.max([drawing.count for drawing in renderers], axis=0)
    out = np.full(N_JOINTS, min(1.0, count[list(TORSO_QUARTERS)].sum() / (4.0 * _FULL_SAMPLES)))
    for name, patches in _PATCHES_OF.items():
        out[INDEX[name]] = min(1.0, count[list(patches)].sum() / _FULL_SAMPLES)
    for j, name in enumerate(INDEX):
        if name.endswith(("UpperLeg", "LowerLeg", "Foot", "Toes")):
            out[j] = 0.0  # the shirt does not show the legs
    return out * min(1.0, agreement / 0.7)
