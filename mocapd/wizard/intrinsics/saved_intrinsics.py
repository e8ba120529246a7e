"""Intrinsics of earlier setups by the camera's model, serial and mode: `lenses.toml` in the state directory."""

import logging
from datetime import datetime
from pathlib import Path
from typing import Annotated

import msgspec
import numpy as np

from mocapd.boundary.files import MissingError, read_text
from mocapd.boundary.parsing import convert, parse_toml
from mocapd.calibrate.intrinsics.intrinsics import Intrinsics
from mocapd.calibration.toml_text import toml_text
from mocapd.capture.kinds.source_kinds import identity_of
from mocapd.errors import ConfigError, MocapdError, NewerFileError, creation_errors
from mocapd.quarantine import quarantine
from mocapd.whole_file import whole_file
from mocapd.wizard.draft import Draft, DraftCamera

FILE_NAME = "lenses.toml"
SCHEMA = 1
_HEADER = """\
# Lenses that mocapd's setup measured, offered when a camera of the same vid:pid:serial is used in the
# same mode again. K and dist (k1 k2 p1 p2 k3) are in pixels. Without a part of it, that is measured again.

"""
_log = logging.getLogger(__name__)
_FIX = "take the file away: lenses are measured again"

_MOST_BYTES = 256_000  # a lens takes 0.5 kB

Finite = Annotated[float, msgspec.Meta(ge=-1e9, le=1e9)]  # NaN is in no range
NotNegative = Annotated[float, msgspec.Meta(ge=0.0, le=1e9)]
Pixels = Annotated[int, msgspec.Meta(ge=16, le=100_000)]
Row3 = tuple[Finite, Finite, Finite]
Row5 = tuple[Finite, Finite, Finite, Finite, Finite]
Positive = Annotated[float, msgspec.Meta(gt=0.0, le=1e9)]


class SavedIntrinsics(msgspec.Struct, frozen=True, kw_only=True):
    """camera: vid:pid:serial; focus: its locked focus; when: UTC."""

    camera: str
    size_px: tuple[Pixels, Pixels]
    when: datetime
    focus: Annotated[int, msgspec.Meta(ge=-(1 << 31), lt=1 << 31)] | None = None
    views: Annotated[int, msgspec.Meta(ge=0, le=10**6)]
    rms_px: NotNegative
    held_out_px: NotNegative
    focal_deviation: Positive
    free: tuple[bool, bool, bool, bool, bool]
    K: tuple[Row3, Row3, Row3]
    dist: Row5

    def __post_init__(self) -> None:
        if not (self.K[0][0] > 0.0 and self.K[1][1] > 0.0 and self.K[2] == (0.0, 0.0, 1.0)):
            raise ValueError("K is not [fx 0 cx, 0 fy cy, 0 0 1]")  # msgspec names the place

    def intrinsics(self) -> Intrinsics:
        """In the form of the step Lens."""
        return Intrinsics(
            self.size_px,
            np.array(self.K),
            np.array(self.dist),
            np.array(self.free),
            self.rms_px,
            self.held_out_px,
            tuple(range(self.views)),
            (),
            self.focal_deviation,
        )


class _File(msgspec.Struct, frozen=True):
    schema: Annotated[int, msgspec.Meta(ge=0, le=10**6)]
    lens: tuple[SavedIntrinsics, ...] = ()


def key_of(camera: DraftCamera) -> str | None:
    """vid:pid:serial; None for a camera without one, which cannot be recognised."""
    identity = identity_of(camera.source)
    return ":".join(identity.model) if identity is not None else None


def read_intrinsics(state_dir: Path) -> tuple[SavedIntrinsics, ...]:
    """All saved ones; empty without the file. Raises ConfigError for a damaged one."""
    path = state_dir / FILE_NAME
    try:
        file: _File = convert(parse_toml(read_text(path, _MOST_BYTES)), _File)
    except MissingError:
        return ()
    except MocapdError as error:
        raise ConfigError(f"cannot be read ({error.what})", str(path), _FIX) from None
    if file.schema != SCHEMA:
        newer = file.schema > SCHEMA
        raise (NewerFileError if newer else ConfigError)(
            f"has schema {file.schema}, not {SCHEMA}", str(path), _FIX
        )
    return file.lens


def find_saved_intrinsics(
    camera: DraftCamera, saved: tuple[SavedIntrinsics, ...]
) -> SavedIntrinsics | None:
    """The intrinsics of this camera in this mode, with the same focus where both are recorded; None, too, where several are
    of such cameras: of identical webcams, it is unknown which one's they are."""
    key, focus = key_of(camera), camera.controls.focus
    same = [
        record
        for record in saved
        if record.camera == key
        and record.size_px == camera.size_px
        and (None in (record.focus, focus) or record.focus == focus)
    ]
    return same[0] if len(same) == 1 else None


def store_intrinsics(draft: Draft, state_dir: Path, when: datetime) -> None:
    """Add the draft's new intrinsics; they replace those of the same camera and mode. An unreadable file goes into
    quarantine.

    For when the calibration is saved. Raises CannotCreateError.
    """
    new = [
        _record_of(key, camera, draft.intrinsics[camera.id], when)
        for camera in draft.cameras
        if (key := key_of(camera)) is not None
        and camera.id in draft.intrinsics
        and camera.id not in draft.intrinsics_saved
    ]
    if not new:
        return
    made = {(record.camera, record.size_px) for record in new}
    path = state_dir / FILE_NAME
    with creation_errors(path, "let this user write there"):
        before = _readable(path)
        rest = [record for record in before if (record.camera, record.size_px) not in made]
        data = msgspec.to_builtins(_File(SCHEMA, (*rest, *new)), builtin_types=(datetime,))
        state_dir.mkdir(parents=True, exist_ok=True)
        with whole_file(path) as partial:
            partial.write_text(_HEADER + toml_text(data), encoding="utf-8")


def _readable(path: Path) -> tuple[SavedIntrinsics, ...]:
    """Earlier ones; empty when they cannot be read. Raises OSError."""
    try:
        return read_intrinsics(path.parent)
    except ConfigError as error:
        moved_to = quarantine(path, "newer" if isinstance(error, NewerFileError) else "corrupt")
        _log.warning("%s %s; it is now %s", path, error.what, moved_to.name)
        return ()


def _record_of(
    key: str, camera: DraftCamera, intrinsics: Intrinsics, when: datetime
) -> SavedIntrinsics:
    K: tuple[Row3, Row3, Row3] = msgspec.convert(
        np.round(intrinsics.K, 4).tolist(), tuple[Row3, Row3, Row3]
    )
    dist: Row5 = msgspec.convert(np.round(intrinsics.dist, 7).tolist(), Row5)
    return SavedIntrinsics(
        camera=key,
        size_px=camera.size_px,
        when=when.replace(microsecond=0),
        focus=camera.controls.focus,
        views=len(intrinsics.views),
        rms_px=round(intrinsics.rms_px, 4),
        held_out_px=round(intrinsics.held_out_px, 4),
        focal_deviation=max(round(intrinsics.focal_deviation, 6), 1e-6),
        free=tuple(intrinsics.free.tolist()),
        K=K,
        dist=dist,
    )
