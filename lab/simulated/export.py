"""Write a scenario as a recorded session with exact ground truth, in the capture format."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from mocapd.body.bones import NAMES
from mocapd.body.skeleton import PARENTS
from mocapd.body.surface import posed_vertices
from mocapd.errors import CannotCreateError, creation_errors
from mocapd.geometry.rig_file import camera_to_dict
from mocapd.sim.film import Progress
from mocapd.sim.renderer import CameraRenderer, camera_renderers
from mocapd.sim.scenario import Scenario
from mocapd.sim.setup import setup_of
from mocapd.sim.world import Performed, World, is_out
from mocapd.types import Bytes, LabelledPicture

LABEL_EVERY = 15  # frames
TRUTH_POINTS = 500  # skin points in truth.npz


@dataclass(frozen=True, slots=True)
class _Job:
    scenario: Scenario
    world: World
    renderers: list[CameraRenderer]
    directory: Path
    frames: int


def export_capture(
    scenario: Scenario,
    directory: Path,
    seconds: float,
    progress: Progress | None = None,
    performed: Performed | None = None,
    notes: Mapping[str, float] | None = None,
) -> None:
    """Record `seconds` of the scenario into a directory, which is made if need be. performed: see `World`; notes:
    more for info.json.

    Every frame is there, as dropped frames belong to the live source; those of an unplugged camera are black, and named.
    The pictures of the shirt and their strokes are left out when it is not worn. Raises CannotCreateError.
    """
    world = World(scenario, performed)
    job = _Job(
        scenario, world, camera_renderers(world), directory, round(seconds * scenario.fps_hz)
    )
    with creation_errors(directory, "choose another directory", "the capture cannot be written"):
        shirt = scenario.clothes.shirt != "plain"
        for folder in (*(("scribble", "model") if shirt else ()), "labels", "masks"):
            (directory / folder).mkdir(parents=True, exist_ok=True)
        _write_texts(job, notes or {})
        if shirt:
            _write_pictures(job)
        _write_truth(job)
        for k in range(len(job.renderers)):
            _write_video(job, k, progress)


def _write_texts(job: _Job, notes: Mapping[str, float]) -> None:
    scenario = job.scenario
    cameras: list[dict[str, Any]] = []
    for k, renderer in enumerate(job.renderers):
        entry = camera_to_dict(renderer.camera)
        entry |= {
            "file": f"cam{k}.mp4",
            "fps": scenario.fps_hz,
            "time_offset_s": renderer.spec.clock_offset_s,
        }
        out = [f for f in range(job.frames) if is_out(scenario, renderer.spec, f)]
        if out:
            entry["lost_frames"] = _runs(out)
        cameras.append(entry)
    events = {
        light.name: [[event.t_s, event.level] for event in light.events]
        for light in scenario.lights
        if light.events
    }
    info: dict[str, Any] = {
        "scenario": scenario.name,
        "outfit": "plain" if scenario.clothes.shirt == "plain" else "shirt",
        "seconds": job.frames / scenario.fps_hz,
        "loop_s": scenario.loop_s,
        "light_events": events,
        "shutter_s": [camera.shutter_s for camera in scenario.cameras],
        "camera_gamma": [camera.gamma for camera in scenario.cameras],
    }
    if scenario.clothes.events:
        info["jacket_events"] = [[event.t_s, event.jacket] for event in scenario.clothes.events]
    if scenario.absences:
        info["absences"] = [[span.from_s, span.to_s] for span in scenario.absences]
    info |= notes
    rig = {"rig": scenario.name, "units": "m", "cameras": cameras}
    subject = {"stature_m": scenario.body.stature_m}
    for name, content in (("rig", rig), ("info", info), ("subject", subject)):
        (job.directory / f"{name}.json").write_text(json.dumps(content, indent=1) + "\n")


def _runs(frames: list[int]) -> list[list[int]]:
    """First and last, exclusive, of each run of consecutive frames."""
    cuts = [i for i in range(1, len(frames)) if frames[i] != frames[i - 1] + 1]
    edges = [0, *cuts, len(frames)]
    return [[frames[a], frames[b - 1] + 1] for a, b in pairwise(edges)]


def _write_pictures(job: _Job) -> None:
    setup = setup_of(job.scenario, job.renderers)
    for k, renderer in enumerate(job.renderers):
        _write_labelled(
            job.directory / "scribble" / f"cam{k}", setup.scribbles[renderer.camera.name]
        )
    for i, image in enumerate(setup.model):
        _write_labelled(job.directory / "model" / str(i), image)


def _write_labelled(stem: Path, image: LabelledPicture) -> None:
    write_png(stem.with_name(stem.name + ".png"), image.pixels)
    write_png(stem.with_name(stem.name + "_strokes.png"), image.labels)


def write_png(path: Path, pixels: Bytes) -> None:
    """A PNG file. Raises OSError."""
    path.write_bytes(bytes(cv2.imencode(".png", pixels)[1]))


def _write_truth(job: _Job) -> None:
    world = job.world
    surface = job.renderers[0].figure.coarse
    points = np.random.default_rng([job.scenario.seed, 8]).permutation(len(surface.vertices_m))
    points = np.sort(points[:TRUTH_POINTS])
    times = np.arange(job.frames) / job.scenario.fps_hz
    joints = np.full((job.frames, len(NAMES), 3), np.nan, dtype=np.float32)
    quats = np.full((job.frames, len(NAMES), 4), np.nan, dtype=np.float32)
    verts = np.full((job.frames, len(points), 3), np.nan, dtype=np.float32)
    for f, t in enumerate(times):
        state = world.at(float(t))
        if state.person_present:
            joints[f], quats[f] = state.joints_m, state.pose.quats_xyzw
            verts[f] = posed_vertices(surface, world.skeleton, state.pose, state.joints_m)[points]
    rest = world.skeleton.rest_m
    offsets = rest - np.where(PARENTS[:, None] >= 0, rest[PARENTS], 0.0)
    np.savez_compressed(
        job.directory / "truth.npz",
        times=times,
        fps=np.array(job.scenario.fps_hz),
        names=np.array(NAMES),
        parents=PARENTS,
        rest_offsets=offsets,
        tpose_joints=rest,
        tpose_verts=surface.vertices_m[points].astype(np.float32),
        joints=joints,
        global_quats=quats,
        verts=verts,
        visible=np.isfinite(joints[:, 0, 0]),
    )


def _write_video(job: _Job, k: int, progress: Progress | None) -> None:
    """cam<k>.mp4 with MPEG-4 Part 2, which every OpenCV can read and write, and its labels."""
    renderer = job.renderers[k]
    path = job.directory / f"cam{k}.mp4"
    fourcc = cv2.VideoWriter.fourcc(*"mp4v")
    video = cv2.VideoWriter(str(path), fourcc, job.scenario.fps_hz, renderer.camera.size_px)
    if not video.isOpened():
        raise CannotCreateError("the video cannot be written", str(path), "check OpenCV's codecs")
    width, height = renderer.camera.size_px
    black = np.zeros((height, width, 3), dtype=np.uint8)
    for f in range(job.frames):
        out = is_out(job.scenario, renderer.spec, f)
        video.write(black if out else renderer.frame(f))
        if f % LABEL_EVERY == 0:
            _write_label(job, k, f)
        if progress is not None:
            progress(k * job.frames + f + 1, len(job.renderers) * job.frames)
    video.release()


def _write_label(job: _Job, k: int, f: int) -> None:
    renderer = job.renderers[k]
    patch, mask, other = renderer.labels_at(renderer.exposure_s(f))
    name = f"cam{k}_{f:06d}"
    write_png(job.directory / "labels" / f"{name}.png", patch)
    write_png(job.directory / "masks" / f"{name}.png", mask)
    write_png(job.directory / "masks" / f"{name}_other.png", other)
