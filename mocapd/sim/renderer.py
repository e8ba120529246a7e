"""Pictures of the world: a pure function of scenario, camera and frame."""

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from mocapd.sim.person.figure import Figure, build_figure
from mocapd.sim.person.figure_kernels import light_vertices, vertex_normals
from mocapd.sim.person.group import Group, PersonBody, group_of, posed_group, visible_patches
from mocapd.sim.render_kernels import accumulate, project_vertices, rasterise
from mocapd.sim.response_kernels import PersonLayer, Sensor, expose, shade_room
from mocapd.sim.scenario import CameraSpec, Scenario
from mocapd.sim.scenery.empty_room import Background, render_background
from mocapd.sim.scenery.furniture import Primitives, furnish
from mocapd.sim.scenery.lamps import Lamps, lamps_of
from mocapd.sim.scenery.shadows import lamp_views, shadow_maps
from mocapd.sim.world import World, light_levels, rig_of
from mocapd.types import Bytes, Camera, Floats, Ints, Pose, Singles

# Drawings per exposure: instants of the open shutter (-1..1) and offsets [px], which also smooth edges
_DRAWINGS = ((-0.667, -0.167, -0.333), (0.0, 0.333, 0.0), (0.667, -0.167, 0.333))
_SHADE_STEP = 4  # shadows on the room are looked up at every fourth pixel, both ways


_ENTRIES = 1 << 15
_NOISE = 1 << 19


def response_curve(camera: CameraSpec) -> Bytes:
    """8-bit values for signals 0..2: gamma, a shoulder, and clipping at full scale."""
    signal = np.linspace(0.0, 2.0, _ENTRIES)
    s = camera.shoulder
    # beyond the shoulder the rest of the range is approached exponentially, with equal slope
    room = max(1.0 - s, 1e-6)
    bent = np.where(signal > s, 1.0 - room * np.exp(-(signal - s) / room), signal)
    return np.round(255.0 * np.clip(bent, 0.0, 1.0) ** (1.0 / camera.gamma)).astype(np.uint8)


def noise_table(seed: int, camera_index: int) -> Singles:
    """Normal deviates that every frame of the camera enters at places of its own."""
    rng = np.random.default_rng([seed, 4, camera_index])
    return rng.standard_normal(_NOISE, dtype=np.float32)


@dataclass(frozen=True, slots=True, eq=False)
class Set:
    """What stands still: room and lamps; `sky` (3,) linear RGB."""

    room: Primitives
    lamps: Lamps
    sky: Floats


def furnished_set(scenario: Scenario) -> Set:
    """The scenario's own room and lights."""
    return Set(furnish(scenario), lamps_of(scenario), np.array(scenario.room.sky))


class CameraRenderer:
    """Draws one camera's pictures. Keeps the empty room and work buffers; used by one thread."""

    def __init__(
        self,
        world: World,
        figures: Sequence[Figure],
        stage: Set,
        index: int,
        samples: int = 3,
    ) -> None:
        """figures: of the person, then of the world's others."""
        scenario = world.scenario
        self._world, self._figures, self._set = world, tuple(figures), stage
        self._groups: dict[tuple[int, ...], Group] = {}
        self.spec: CameraSpec = scenario.cameras[index]
        self.camera: Camera = rig_of(scenario).cameras[index]
        self.background: Background = render_background(
            self.camera, stage.room, stage.lamps, stage.sky, samples
        )
        width, height = self.camera.size_px
        gains = (self.spec.gain * np.array(self.spec.white_balance)).astype(np.float32)
        self._sensor = Sensor(
            gains, self.spec.vignetting, self.spec.shot_noise, self.spec.read_noise,
            noise_table(scenario.seed, index), response_curve(self.spec),
        )  # fmt: skip
        self._lit: tuple[Floats, Singles] | None = None
        self._nearness = np.zeros((height, width), dtype=np.float32)
        self._owner = np.full((height, width), -1, dtype=np.int32)
        self._weights = np.zeros((height, width, 2), dtype=np.float32)
        self._colour = np.zeros((height, width, 3), dtype=np.float32)
        self._cover = np.zeros((height, width), dtype=np.float32)
        self._points = np.zeros((sum(len(one.vertices_m) for one in figures), 3))

    @property
    def figure(self) -> Figure:
        """The person that is drawn."""
        return self._figures[0]

    def exposure_s(self, frame: int) -> float:
        """World time of the middle of the exposure of a frame [s]."""
        return frame / self._world.scenario.fps_hz + self.spec.clock_offset_s

    def frame(self, frame: int) -> Bytes:
        """The picture (H,W,3) BGR of frame number `frame` >= 0, with the person once she is there."""
        t = self.exposure_s(frame)
        levels = light_levels(self._world.scenario, t)
        half = 0.5 * self.spec.shutter_s
        there = self._there(t)
        return self._picture(
            there, self._bodies(there, t - half), self._bodies(there, t + half), levels, frame
        )

    def picture(
        self,
        shutter: tuple[Pose, Pose] | None,
        levels: Floats,
        noise_key: int,
        jacket: float = 0.0,
    ) -> Bytes:
        """A picture of the person alone moving between two poses, None: the empty room."""
        there = (0,) if shutter is not None else ()
        opened, closed = ([PersonBody(pose, jacket)] for pose in shutter) if shutter else ([], [])
        return self._picture(there, opened, closed, levels, noise_key)

    def picture_of_group(
        self, opened: list[PersonBody], closed: list[PersonBody], levels: Floats, noise_key: int
    ) -> Bytes:
        """A picture of as many figures, the person first, moving between two sets of poses."""
        return self._picture(tuple(range(len(opened))), opened, closed, levels, noise_key)

    def _there(self, t_s: float) -> tuple[int, ...]:
        """Who is in the picture: 0 the person, from 1 on the others."""
        others = range(1, len(self._figures))
        return (0, *others) if self._world.present(t_s) else tuple(others)

    def _bodies(self, there: tuple[int, ...], t_s: float) -> list[PersonBody]:
        worlds = (self._world, *self._world.others)
        return [
            PersonBody(worlds[i].pose(t_s), worlds[i].jacket(t_s), worlds[i].screen) for i in there
        ]

    def _group(self, there: tuple[int, ...]) -> Group:
        if there not in self._groups:
            self._groups[there] = group_of([self._figures[i] for i in there])
        return self._groups[there]

    def _picture(
        self,
        there: tuple[int, ...],
        at_opening: list[PersonBody],
        at_closing: list[PersonBody],
        levels: Floats,
        noise_key: int,
    ) -> Bytes:
        lamps = self._set.lamps
        width, height = self.camera.size_px
        shade = np.zeros((len(levels), height, width), dtype=np.float32)
        box = (0, 0, 0, 0)
        if there:
            group = self._group(there)
            opened, closed = (posed_group(group, bodies) for bodies in (at_opening, at_closing))
            middle = 0.5 * (opened + closed)
            # the person alone throws a shadow
            own = middle[: len(self._figures[0].vertices_m) if there[0] == 0 else 0]
            views = lamp_views(lamps, own.mean(axis=0) if len(own) else np.zeros(3))
            triangles = self._figures[0].triangles[: None if len(own) else 0]
            depths = shadow_maps(own, triangles, views, levels)
            self._shade(views, depths, shade)
            irradiance = self._irradiance(group, middle, levels, views, depths)
            jackets = np.array([body.jacket for body in at_opening])
            box = self._draw(group, opened, closed, irradiance, jackets)
        out = self._expose(levels, shade, self._colour, self._cover, box, noise_key)
        self._colour[:] = 0.0
        self._cover[:] = 0.0
        return out

    def picture_of(self, colour: Singles, cover: Singles, levels: Floats, noise_key: int) -> Bytes:
        """A picture of the room, empty but for something that covers (H,W) 0..1 of the pixels and
        sends the light colour (H,W,3), linear RGB times cover. It throws no shadow."""
        height, width = cover.shape
        shade = np.zeros((len(levels), height, width), dtype=np.float32)
        return self._expose(levels, shade, colour, cover, (0, 0, width, height), noise_key)

    def _expose(
        self, levels: Floats, shade: Singles, colour: Singles, cover: Singles,
        box: tuple[int, int, int, int], noise_key: int,
    ) -> Bytes:  # fmt: skip
        out = np.empty((*cover.shape, 3), dtype=np.uint8)
        expose(
            self._room(levels), self.background.layers, levels.astype(np.float32), shade,
            PersonLayer(colour, cover, box), self._sensor, noise_key, out,
        )  # fmt: skip
        return out

    def labels(self, pose: Pose, jacket: float = 0.0) -> tuple[Bytes, Bytes]:
        """Exact labels of the person alone: patch index (H,W) 0..20, and 255 where she is."""
        owner = self._owners((0,), [PersonBody(pose, jacket)])
        visible = owner >= 0
        patch = np.where(visible, visible_patches(self.figure, jacket)[np.maximum(owner, 0)], 0)
        return patch.astype(np.uint8), _mask(visible)

    def labels_at(self, t_s: float) -> tuple[Bytes, Bytes, Bytes]:
        """Exact labels at one instant: patch index (H,W) 0..20, 255 where the person is visible, and where another is."""
        there = self._there(t_s)
        width, height = self.camera.size_px
        if not there:
            nothing = np.zeros((height, width), dtype=np.uint8)
            return nothing, nothing, nothing
        owner = self._owners(there, self._bodies(there, t_s))
        own = len(self.figure.triangles) if there[0] == 0 else 0
        person = (owner >= 0) & (owner < own)
        patches = visible_patches(self.figure, self._world.jacket(t_s))
        patch = np.where(person, patches[np.clip(owner, 0, len(patches) - 1)], 0)
        return patch.astype(np.uint8), _mask(person), _mask(owner >= own)

    def mask_of_group(self, bodies: list[PersonBody]) -> Bytes:
        """255 where the person (H,W) is visible among these figures, the person first."""
        owner = self._owners(tuple(range(len(bodies))), bodies)
        return _mask((owner >= 0) & (owner < len(self.figure.triangles)))

    def _owners(self, there: tuple[int, ...], bodies: list[PersonBody]) -> Ints:
        """The triangle (H,W) of the group that each pixel sees, -1: none."""
        group = self._group(there)
        points, _ = self._project(posed_group(group, bodies))
        rasterise(points, group.triangles, 0.0, 0.0, self._nearness, self._owner, self._weights)
        owner = self._owner.astype(np.int64)
        self._nearness[:] = 0.0
        self._owner[:] = -1
        return owner

    def _irradiance(
        self, group: Group, vertices_m: Floats, levels: Floats, views: Floats, depths: Singles
    ) -> Singles:
        lamps = self._set.lamps
        normals = np.empty_like(vertices_m)
        vertex_normals(vertices_m, group.triangles, normals)
        out = np.empty(vertices_m.shape, dtype=np.float32)
        light_vertices(
            vertices_m, normals, lamps.at_m, lamps.rgb * levels[:, None], lamps.sun,
            lamps.ambient_up, lamps.ambient_down, views, depths, out,
        )  # fmt: skip
        return out

    def _room(self, levels: Floats) -> Singles:
        """The empty room in this light; computed again only after a change of the light."""
        if self._lit is None or not np.array_equal(levels, self._lit[0]):
            self._lit = (levels, self.background.lit(levels))
        return self._lit[1]

    def _shade(self, views: Floats, depths: Singles, out: Singles) -> None:
        """The person's shadow on the room, out (L,H,W) 0..1."""
        _, height, width = out.shape
        coarse = np.empty((len(out), height // _SHADE_STEP, width // _SHADE_STEP), np.float32)
        shade_room(self.background.points_m, views, depths, _SHADE_STEP, coarse)
        for full, part in zip(out, coarse, strict=True):
            if part.any():
                cv2.resize(part, (width, height), dst=full, interpolation=cv2.INTER_LINEAR)

    def _project(self, vertices_m: Floats) -> tuple[Floats, tuple[int, int, int, int]]:
        camera, points = self.camera, self._points[: len(vertices_m)]
        box: tuple[int, int, int, int] = project_vertices(
            vertices_m, camera.R, camera.t_m, camera.K, camera.dist, camera.size_px, points
        )
        return points, box

    def _draw(
        self, group: Group, opened: Floats, closed: Floats, irradiance: Singles, jackets: Floats
    ) -> tuple[int, int, int, int]:
        """Draw the group into colour and cover; returns the box that was touched."""
        boxes = []
        for u, dx, dy in _DRAWINGS:
            points, box = self._project(0.5 * ((1 - u) * opened + (1 + u) * closed))
            rasterise(points, group.triangles, -dx, -dy, self._nearness, self._owner, self._weights)
            accumulate(
                group.triangles, group.albedo, irradiance, self._nearness, self._owner,
                self._weights, box, 1.0 / len(_DRAWINGS), group.dress, jackets, self._colour, self._cover,
            )  # fmt: skip
            boxes.append(box)
        low, high = np.min(boxes, axis=0), np.max(boxes, axis=0)
        return int(low[0]), int(low[1]), int(high[2]), int(high[3])


def _mask(where: NDArray[np.bool_]) -> Bytes:
    return np.where(where, 255, 0).astype(np.uint8)


def camera_renderers(world: World, samples: int = 3) -> list[CameraRenderer]:
    """One renderer per camera of the scenario."""
    scenario = world.scenario
    figures = [figure_of(one) for one in (world, *world.others)]
    stage = furnished_set(scenario)
    n = len(scenario.cameras)
    with ThreadPoolExecutor(n) as pool:  # each casts its room, which takes two seconds
        return list(pool.map(lambda i: CameraRenderer(world, figures, stage, i, samples), range(n)))


def figure_of(world: World) -> Figure:
    scenario = world.scenario
    return build_figure(world.shape, scenario.clothes, scenario.seed, whole=scenario.body.whole)
