"""Proposes strokes on the frozen pictures with the setup's present data: rig, lenses, stature."""

from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from mocapd.calibrate.colours.light_reading import MEAN_STATURE_M
from mocapd.calibrate.colours.stroke_proposal import Proposal, propose_strokes
from mocapd.errors import InputError
from mocapd.geometry.nominal_rig import nominal_rig
from mocapd.shirt.colour.from_pictures import colour_model
from mocapd.shirt.pose_database.database import PoseDatabase
from mocapd.shirt.pose_database.database_file import load_or_build
from mocapd.types import Bytes, Camera, Rig
from mocapd.wizard.draft import Draft
from mocapd.wizard.step import Tell

_THREADS = 2  # the kernels release the GIL
_LOOKING = "looking for the shirt in any light"
_LOADED = 0.1  # share of the work for loading the database


LoadDatabase = Callable[[Path, Tell], PoseDatabase]


def pose_database(cache_dir: Path, report: Tell) -> PoseDatabase:
    """Loads the database from the cache, or makes it, which takes a minute or two."""
    report("loading the pose database", 0.0)
    with ThreadPoolExecutor(_THREADS) as pool:
        return load_or_build(
            cache_dir,
            progress=lambda share: report("making the pose database, once only", _LOADED * share),
            map_chunks=pool.map,
        ).database


def propose(
    pictures: Mapping[str, Bytes],
    draft: Draft,
    cache_dir: Path,
    report: Tell,
    load: LoadDatabase = pose_database,
) -> dict[str, Proposal | InputError]:
    """By camera: strokes, or the reason for none. Raises only the database's CannotCreateError."""
    database = load(cache_dir, report)
    model = colour_model(())
    stature_m = draft.stature_m if draft.stature_m is not None else MEAN_STATURE_M
    report(_LOOKING, _LOADED)
    rig = draft.rig
    if rig is not None and len(pictures) > 1 and set(pictures) <= set(rig.names):
        try:
            with ThreadPoolExecutor(_THREADS) as pool:
                proposals = propose_strokes(
                    pictures, rig, model, database, stature_m,
                    lambda share: report(_LOOKING, _LOADED + (1.0 - _LOADED) * share), pool.map,
                )  # fmt: skip
        except InputError as error:
            return dict.fromkeys(pictures, error)
        return {name: proposals.get(name) or _no_shirt(name) for name in pictures}
    done: list[str] = []

    def alone(name: str) -> Proposal | InputError:
        camera = _camera(name, draft, pictures[name])
        shown = {camera.name: pictures[name]}
        try:
            found = propose_strokes(shown, Rig((camera,)), model, database, stature_m)
            return found[camera.name]
        except InputError as error:
            return error
        finally:
            done.append(name)
            report(_LOOKING, _LOADED + (1.0 - _LOADED) * len(done) / len(pictures))

    with ThreadPoolExecutor(_THREADS) as pool:
        return dict(zip(pictures, pool.map(alone, pictures), strict=True))


def _no_shirt(camera: str) -> InputError:
    return InputError(
        "no shirt was found under any light",
        camera,
        "stand where this camera sees the whole upper body, or draw the strokes by hand",
    )


def _camera(name: str, draft: Draft, pixels: Bytes) -> Camera:
    """The camera with its intrinsics, at a nominal pose; a usual webcam without intrinsics."""
    if draft.rig is not None and name in draft.rig.names:
        return draft.rig.cameras[draft.rig.names.index(name)]
    intrinsics = draft.intrinsics.get(name)
    if intrinsics is None:
        height, width = pixels.shape[:2]
        return nominal_rig("camera", (width, height)).cameras[0]
    usual = nominal_rig(name, intrinsics.size_px).cameras[0]
    return Camera(name, intrinsics.size_px, intrinsics.K, intrinsics.dist, usual.R, usual.t_m)
