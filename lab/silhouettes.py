"""How well each camera's silhouette of the tracked person is the true one, by captures with exact masks.

python -m lab.silhouettes CAPTURE... [--tracker markerless]

Intersection over union in the region about the tracked body, at every picture whose mask is known: of what stands before the
learned background, of the pixels that the network takes for the person, and of the regions that the tracker fits to.
"""

from collections.abc import Mapping
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
from mocapd.tracking.cues.clothes.camera_views import CameraView
from mocapd.types import Bytes
from mocapd.vision.foreground_kernels import stands

Mask = NDArray[np.bool_]
_KINDS = ("background", "network", "regions")


def silhouettes(
    captures: Annotated[list[Path], typer.Argument(help="Folders of captures with masks/.")],
    tracker: TrackerOption = None,
) -> None:
    """A row for each capture: mean intersection over union."""
    config = prepared_config(None, None, tracker)
    typer.echo(f"{'capture':24}" + "".join(f"{kind:>12}" for kind in _KINDS) + "   pictures")
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
            row = "".join(f"{np.nanmean([one[kind] for one in found]):12.3f}" for kind in _KINDS)
            typer.echo(f"{folder.name:24}{row}{len(found):11}")


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
        views = {one.name: one for one in tracker.clothes.cameras.each}
        for name, frame in frames.frames.items():
            path = capture.path / "masks" / f"{name}_{frame.seq:06d}.png"
            if path.exists() and views[name].near is not None:
                true = np.asarray(cv2.imread(str(path), cv2.IMREAD_GRAYSCALE), np.uint8)
                found.append(_of_picture(views[name], true, track))
    return found


def _of_picture(view: CameraView, true: Bytes, track: Track) -> Mapping[str, float]:
    h, w = view.drawn.shape
    mask = cv2.resize(true, (w, h), interpolation=cv2.INTER_AREA) > 127
    x0, y0, x1, y1 = view.near or (0, 0, w, h)
    here = np.s_[y0:y1, x0:x1]
    regions = np.zeros((h, w), bool)
    if view.name in track.evidence:
        left, top, right, bottom = (px // view.image_scale for px in track.roi_px[view.name])
        regions[top:bottom, left:right] = track.evidence[view.name] > 0
    kinds = {
        "background": stands(view.foreground),
        "network": view.person_odds > 0.0 if view.person_odds.any() else None,
        "regions": regions,
    }
    return {
        kind: np.nan if one is None else _overlap(one[here], mask[here])
        for kind, one in kinds.items()
    }


def _overlap(one: Mask, other: Mask) -> float:
    return float((one & other).sum() / max((one | other).sum(), 1))


if __name__ == "__main__":
    run(silhouettes)
