"""The one place where a tracker is built, and what it may know of rig, wearer and light is read."""

import logging
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np

from mocapd.body.shirt import N_COLOURS, standard_shirt
from mocapd.boundary.files import is_file, is_folder
from mocapd.capture.capture_folder import CaptureFolder
from mocapd.config.sections import CameraSection, TrackerSection
from mocapd.errors import ConfigError, InputError
from mocapd.shirt.colour.strokes import read_labelled, stroked_pictures, strokes_beside
from mocapd.trackers import registry
from mocapd.trackers.base import Tracker
from mocapd.trackers.registry import TrackerInputs, build
from mocapd.trackers.tracking_state import TrackingStateParams
from mocapd.types import LabelledPicture, Rig

Progress = Callable[[str, int, int], None]  # what is being made, parts done, parts in all

_log = logging.getLogger(__name__)
_THREADS = 2  # that make what is kept in the cache
_PAINT = "paint the colours of the shirt again"


def build_tracker(name: str, inputs: TrackerInputs) -> Tracker:
    """The tracker of this name, ready to step. Raises ConfigError naming what it lacks."""
    with _pooled(inputs) as pooled:
        return build(name, pooled)


def make_caches(name: str, cache_dir: Path, progress: Progress) -> None:
    """What this tracker keeps in the cache folder, made if need be."""
    nobody = TrackerInputs(rig=None, stature_m=TrackerSection().stature_m)
    with _pooled(with_cache(nobody, cache_dir, progress)) as pooled:
        registry.make_caches(name, pooled)


@contextmanager
def _pooled(inputs: TrackerInputs) -> Iterator[TrackerInputs]:
    """With threads to make caches, and a log to tell of them."""
    pool = ThreadPoolExecutor(_THREADS)
    try:
        yield replace(inputs, map_chunks=pool.map, tell=_log.warning)
    finally:
        # who was told to end does not wait for all that is queued
        pool.shutdown(wait=False, cancel_futures=True)


def with_cache(inputs: TrackerInputs, cache_dir: Path, progress: Progress) -> TrackerInputs:
    """The same, with a place for what is made once, and bars while it is made."""
    return replace(
        inputs,
        cache_dir=cache_dir,
        progress=lambda share: progress("pose database", round(100 * share), 100),
    )


def inputs_of_capture(
    folder: CaptureFolder,
    stature_m: float,
    variant: str = "full",
    tracking: TrackingStateParams | None = None,
) -> TrackerInputs:
    """What a capture folder tells; `stature_m` is for folders that do not say."""
    return TrackerInputs(
        rig=folder.rig,
        stature_m=folder.stature_m or stature_m,
        model=read_model(folder.model),
        white_balance={
            c.name: read_labelled(c.scribble) for c in folder.cameras if c.scribble is not None
        },
        variant=variant,
        tracking=tracking,
    )


def inputs_of_config(
    tracker: TrackerSection, cameras: tuple[CameraSection, ...], rig: Rig | None
) -> TrackerInputs:
    """What the configuration tells."""
    folder = tracker.colour_model
    return TrackerInputs(
        rig=rig,
        stature_m=tracker.stature_m,
        model=read_model(stroked_folder(folder)) if folder else (),
        white_balance={
            c.id: read_labelled(stroked_image(c.white_balance)) for c in cameras if c.white_balance
        },
        variant=tracker.variant,
        tracking=tracker,
    )


def stroked_image(image: Path) -> Path:
    """The same image. Raises InputError when it is missing, or the strokes beside it are."""
    for path in (image, strokes_beside(image)):
        if not is_file(path):
            raise InputError("no such file", str(path), _PAINT)
    return image


def stroked_folder(folder: Path) -> tuple[Path, ...]:
    """Every image of a folder, its strokes beside it. Raises InputError when there is none."""
    images = stroked_pictures(folder) if is_folder(folder) else []
    if not images:
        raise InputError("holds no image", str(folder), "it should hold 0.png, 0_strokes.png, ...")
    return tuple(stroked_image(image) for image in images)


def read_model(images: tuple[Path, ...]) -> tuple[LabelledPicture, ...]:
    """The images of the shirt. Raises ConfigError when a colour has no stroke on any of them."""
    pictures = tuple(read_labelled(image) for image in images)
    if pictures:
        painted = np.unique(np.concatenate([np.unique(p.labels) for p in pictures]))
        missing = sorted(set(range(1, N_COLOURS + 1)) - set(painted.tolist()))
        if missing:
            names = ", ".join(f"{i} ({standard_shirt().colour_names[i - 1]})" for i in missing)
            raise ConfigError(
                f"no stroke of colour {names} on any image",
                str(images[0].parent),
                "paint it where the shirt shows it",
            )
    return pictures
