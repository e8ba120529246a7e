"""Pictures of the world: a pure function of scenario, camera and frame."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import cv2
import numpy as np

from mocapd.sim.person.figure import Figure, build_figure, posed_figure
from mocapd.sim.person.figure_kernels import light_vertices, vertex_normals
from mocapd.sim.render_kernels import accumulate, project_vertices, rasterise
from mocapd.sim.response import noise_table, response_curve
from mocapd.sim.response_kernels import PersonLayer, Sensor, expose, shade_room
from mocapd.sim.scenario import CameraSpec, Scenario
from mocapd.sim.scenery.empty_room import Background, render_background
from mocapd.sim.scenery.furniture import Primitives, furnish
from mocapd.sim.scenery.lamps import Lamps, lamps_of
from mocapd.sim.scenery.shadows import lamp_views, shadow_maps
from mocapd.sim.world import World, light_levels, rig_of
from mocapd.types import Bytes, Camera, Floats, Pose, Singles

# Drawings per exposure: instants of the open shutter (-1..1) and offsets [px], which also smooth edges
_DRAWINGS = ((-0.667, -0.167, -0.333), (0.0, 0.333, 0.0), (0.667, -0.167, 0.333))
_SHADE_STEP = 4  # shadows on the room are looked up at every fourth pixel, both ways


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
        self, world: World, figure: Figure, stage: Set, index: int, samples: int = 3
    ) -> None:
        scenario = world.scenario
        self._world, self._figure, self._set = world, figure, stage
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
        self._points = np.zeros_like(figure.vertices_m)

    @property
    def figure(self) -> Figure:
        """The person that is drawn."""
        return self._figure

    def exposure_s(self, frame: int) -> float:
        """World time of the middle of the exposure of a frame [s]."""
        return frame / self._world.scenario.fps_hz + self.spec.clock_offset_s

    def frame(self, frame: int) -> Bytes:
        """The picture (H,W,3) BGR of frame number `frame` >= 0, with the person once she is there."""
        t = self.exposure_s(frame)
        levels = light_levels(self._world.scenario, t)
        if t < self._world.scenario.person_appears_s:
            return self.picture(None, levels, frame)
        half = 0.5 * self.spec.shutter_s
        poses = (self._world.pose(t - half), self._world.pose(t + half))
        return self.picture(poses, levels, frame)

    def picture(self, shutter: tuple[Pose, Pose] | None, levels: Floats, noise_key: int) -> Bytes:
        """A picture of the person moving between two poses, None: the empty room."""
        lamps = self._set.lamps
        width, height = self.camera.size_px
        shade = np.zeros((len(levels), height, width), dtype=np.float32)
        box = (0, 0, 0, 0)
        if shutter is not None:
            opened, closed = (posed_figure(self._figure, pose) for pose in shutter)
            middle = 0.5 * (opened + closed)
            views = lamp_views(lamps, middle.mean(axis=0))
            depths = shadow_maps(middle, self._figure.triangles, views, levels)
            self._shade(views, depths, shade)
            box = self._draw(opened, closed, self._irradiance(middle, levels, views, depths))
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

    def labels(self, pose: Pose) -> tuple[Bytes, Bytes]:
        """Exact labels at one instant: patch index (H,W) 0..20, and 255 where the person is."""
        vertices = posed_figure(self._figure, pose)
        self._project(vertices)
        rasterise(
            self._points,
            self._figure.triangles,
            0.0,
            0.0,
            self._nearness,
            self._owner,
            self._weights,
        )
        owner = self._owner.copy()
        self._nearness[:] = 0.0
        self._owner[:] = -1
        seen = owner >= 0
        patch = np.where(seen, self._figure.patch[np.maximum(owner, 0)], 0).astype(np.uint8)
        return patch, np.where(seen, 255, 0).astype(np.uint8)

    def _irradiance(
        self, vertices_m: Floats, levels: Floats, views: Floats, depths: Singles
    ) -> Singles:
        lamps = self._set.lamps
        normals = np.empty_like(vertices_m)
        vertex_normals(vertices_m, self._figure.triangles, normals)
        out = np.empty(vertices_m.shape, dtype=np.float32)
        light_vertices(
            vertices_m, normals, lamps.at_m, lamps.rgb * levels[:, None], lamps.sun,
            lamps.ambient_up, lamps.ambient_down, views, depths, out,
        )  # fmt: skip
        return out

    def _room(self, levels: Floats) -> Singles:
        """The empty room in this light; summed anew only when the light has changed."""
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

    def _project(self, vertices_m: Floats) -> tuple[int, int, int, int]:
        camera = self.camera
        box: tuple[int, int, int, int] = project_vertices(
            vertices_m, camera.R, camera.t_m, camera.K, camera.dist, camera.size_px, self._points
        )
        return box

    def _draw(
        self, opened: Floats, closed: Floats, irradiance: Singles
    ) -> tuple[int, int, int, int]:
        """Draw the person into colour and cover; returns the box that was touched."""
        figure = self._figure
        boxes = []
        for u, dx, dy in _DRAWINGS:
            box = self._project(0.5 * ((1 - u) * opened + (1 + u) * closed))
            rasterise(
                self._points, figure.triangles, -dx, -dy, self._nearness, self._owner, self._weights
            )
            accumulate(
                figure.triangles, figure.albedo, irradiance, self._nearness, self._owner,
                self._weights, box, 1.0 / len(_DRAWINGS), self._colour, self._cover,
            )  # fmt: skip
            boxes.append(box)
        low, high = np.min(boxes, axis=0), np.max(boxes, axis=0)
        return int(low[0]), int(low[1]), int(high[2]), int(high[3])


def camera_renderers(world: World, samples: int = 3) -> list[CameraRenderer]:
    """One renderer per camera of the scenario."""
    scenario = world.scenario
    figure = build_figure(world.shape, scenario.clothes, scenario.seed)
    stage = furnished_set(scenario)
    n = len(scenario.cameras)
    with ThreadPoolExecutor(n) as pool:  # each casts its room, which takes two seconds
        return list(pool.map(lambda i: CameraRenderer(world, figure, stage, i, samples), range(n)))
