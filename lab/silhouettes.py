"""How well each camera's silhouette of the tracked person is the true one, by captures with exact masks.

python -m lab.silhouettes CAPTURE... [--tracker markerless]

Intersection over union in the region about the tracked body, at every picture whose mask is known: of what stands before the
learned background, of the pixels that the network takes for the person, of the regions that the tracker fits to, and of the
sum of their log-odds (`soft`). With three cameras or more: the visual hull of these log-odds beside that of the true masks,
how much of it is kept, and its volume as a share.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated

import cv2
import numpy as np
import typer
from numpy.typing import NDArray

from lab.command_line import TrackerOption, prepared_config, run
from mocapd.app.terminal.progress import ProgressBars
from mocapd.body.shape import BodyShape
from mocapd.calibration.from_origin import from_capture
from mocapd.capture.capture_folder import CaptureFolder, frame_sets, load_folder
from mocapd.errors import ConfigError
from mocapd.session.tracker_setup import cache_resources, ready_tracker
from mocapd.tracking.base import Track
from mocapd.tracking.body_tracker import BodyTracker
from mocapd.tracking.cues.clothes.camera_view import CameraView
from mocapd.types import Camera, Floats, Singles
from mocapd.vision.foreground_kernels import BACKGROUND, BEFORE, CLOTH_OR_SHADOW, SHADOW, stands
from mocapd.vision.hull.ray_hull import CERTAIN, carve_log_odds, voxel_centres

Mask = NDArray[np.bool_]
_KINDS = ("background", "network", "regions", "soft")
_HULL = ("hull kept", "hull volume")
_REACH_M = 1.0  # of the hull, around the hips
_VOXEL_M = 0.03
# log-odds of the person: by what the background says of a pixel, of one of the clothes' regions, of other foreground beside
# these, and a share of the network's
_BY_LABEL = np.zeros(256, np.float32)
_BY_LABEL[[BACKGROUND, BEFORE, SHADOW, CLOTH_OR_SHADOW]] = -3.0, 1.0, -2.0, 0.0
_BY_REGION, _OTHER = 1.5, -1.0
_OF_NETWORK = 1.0


def silhouettes(
    captures: Annotated[list[Path], typer.Argument(help="Folders of captures with masks/.")],
    tracker: TrackerOption = None,
) -> None:
    """A row for each capture: mean intersection over union."""
    config = prepared_config(None, None, tracker)
    typer.echo(
        f"{'capture':24}" + "".join(f"{kind:>12}" for kind in _KINDS + _HULL) + "   pictures"
    )
    with ProgressBars() as progress:
        resources = cache_resources(config.cache_dir, progress)
        for folder in captures:
            capture = load_folder(folder)
            known = from_capture(capture).assuming(config.tracker.stature_m)
            ready = ready_tracker(config.tracker.name, known, resources)
            if not isinstance(ready.tracker, BodyTracker) or ready.tracker.clothes is None:
                raise ConfigError(
                    f"the tracker {config.tracker.name!r} has no silhouettes", "--tracker", "auto"
                )
            found = _of_capture(ready.tracker, ready.shape, capture)
            row = "".join(f"{_mean(found, kind):12.3f}" for kind in _KINDS + _HULL)
            typer.echo(f"{folder.name:24}{row}{sum('soft' in one for one in found):11}")


def _of_capture(
    tracker: BodyTracker, shape: BodyShape, capture: CaptureFolder
) -> list[Mapping[str, float]]:
    """Of each picture whose mask is known, while somebody is tracked: the overlap of each kind."""
    found: list[Mapping[str, float]] = []
    for frames in frame_sets(capture):
        track = tracker.step(frames, shape)
        shape = track.shape
        if track.body.pose is None or tracker.clothes is None:
            continue
        true: dict[str, Mask] = {}
        soft: dict[str, Singles] = {}
        for view in tracker.clothes.cameras.each:
            frame = frames.frames.get(view.name)
            if frame is None or view.near is None:
                continue
            path = capture.path / "masks" / f"{view.name}_{frame.seq:06d}.png"
            if path.exists():
                h, w = view.drawn.shape
                picture = np.asarray(cv2.imread(str(path), cv2.IMREAD_GRAYSCALE), np.uint8)
                true[view.name] = cv2.resize(picture, (w, h), interpolation=cv2.INTER_AREA) > 127
                soft[view.name] = _log_odds(view, track)
                found.append(_of_picture(view, true[view.name], soft[view.name], track))
        cameras = [camera for camera in tracker.rig.cameras if camera.name in true]
        if len(cameras) > 2:
            found.append(_of_hull(cameras, true, soft, track.body.pose.root_m))
    return found


def _mean(found: Sequence[Mapping[str, float]], kind: str) -> float:
    """NaN where there are none."""
    values = np.array([one[kind] for one in found if kind in one])
    values = values[np.isfinite(values)]
    return float(values.mean()) if len(values) else np.nan


def _of_hull(
    cameras: Sequence[Camera],
    true: Mapping[str, Mask],
    soft: Mapping[str, Singles],
    hips_m: Floats,
) -> Mapping[str, float]:
    points_m, _ = voxel_centres(hips_m + _REACH_M * np.array([[-1.0], [1.0]]), _VOXEL_M)
    certain = [np.where(true[one.name], CERTAIN, -CERTAIN).astype(np.float32) for one in cameras]
    wanted = carve_log_odds(cameras, certain, points_m) > 0.0
    got = carve_log_odds(cameras, [soft[one.name] for one in cameras], points_m) > 0.0
    n = max(int(wanted.sum()), 1)
    return {"hull kept": (wanted & got).sum() / n, "hull volume": got.sum() / n}


def _regions(view: CameraView, track: Track) -> Mask:
    regions = np.zeros(view.drawn.shape, bool)
    if view.name in track.evidence:
        left, top, right, bottom = (px // view.image_scale for px in track.roi_px[view.name])
        regions[top:bottom, left:right] = track.evidence[view.name] > 0
    return regions


def _log_odds(view: CameraView, track: Track) -> Singles:
    """That each pixel (h,w) of the work picture is the person's; background beyond the region about the body."""
    x0, y0, x1, y1 = view.near or (0, 0, 0, 0)
    here = np.s_[y0:y1, x0:x1]
    odds = np.full(view.drawn.shape, _BY_LABEL[BACKGROUND])
    by_picture = _BY_LABEL[view.foreground]
    if track.body.tracker == "clothes":  # a shirt's labels are not of the legs
        foreground = stands(view.foreground)
        by_picture[foreground] = np.minimum(by_picture[foreground], np.float32(_OTHER))
        by_picture[_regions(view, track)] = _BY_REGION
    odds[here] = (by_picture + np.float32(_OF_NETWORK) * view.person_odds)[here]
    return odds


def _of_picture(view: CameraView, mask: Mask, soft: Singles, track: Track) -> Mapping[str, float]:
    h, w = view.drawn.shape
    x0, y0, x1, y1 = view.near or (0, 0, w, h)
    here = np.s_[y0:y1, x0:x1]
    kinds = {
        "background": stands(view.foreground),
        "network": view.person_odds > 0.0 if view.person_odds.any() else None,
        "regions": _regions(view, track),
        "soft": soft > 0.0,
    }
    return {
        kind: np.nan if one is None else _overlap(one[here], mask[here])
        for kind, one in kinds.items()
    }


def _overlap(one: Mask, other: Mask) -> float:
    return float((one & other).sum() / max((one | other).sum(), 1))


if __name__ == "__main__":
    run(silhouettes)
