"""Metadata of a recording, as attached files: the rig, the wearer, pictures of the shirt.

The files have the capture format: `rig.json`, `wearer.json`, and pictures with stroke files,
`white_balance/<camera>.png` and `model/<n>.png`. Camera addresses, which may hold passwords, are not included.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import cv2
import msgspec

from mocapd.boundary.image_decoding import MOST_DRAWN_PIXELS, decode_picture
from mocapd.boundary.mcap_records import McapAttachment
from mocapd.boundary.numbers import finite_number
from mocapd.boundary.parsing import decode_json
from mocapd.capture.capture_folder import STATURES_M
from mocapd.errors import ConfigError, InputError, MalformedError
from mocapd.geometry.rig_file import camera_from_dict, camera_to_dict, require_plausible
from mocapd.types import Bytes, LabelledPicture, Rig

RIG, WEARER = "rig.json", "wearer.json"
_WHITE, _MODEL = "white_balance/", "model/"
_STROKES = "_strokes"
_JSON, _PNG = "application/json", "image/png"
_COLOURS = 10
_MOST_PICTURES = 64


class _RigFile(msgspec.Struct, frozen=True):
    cameras: list[dict[str, Any]]


class _WearerFile(msgspec.Struct, frozen=True):
    stature_m: float


@dataclass(frozen=True, slots=True, eq=False)
class RecordingMetadata:
    """None or empty: not recorded. model: the shirt in neutral light; white_balance: by camera."""

    rig: Rig | None = None
    stature_m: float | None = None
    model: tuple[LabelledPicture, ...] = ()
    white_balance: Mapping[str, LabelledPicture] = field(default_factory=dict)


def attachments_of(metadata: RecordingMetadata) -> list[McapAttachment]:
    """Encodes metadata as attached files."""
    files = []
    if metadata.rig is not None:
        rig = {"cameras": [camera_to_dict(camera) for camera in metadata.rig.cameras]}
        files.append(McapAttachment(RIG, _JSON, msgspec.json.encode(rig)))
    if metadata.stature_m is not None:
        wearer = msgspec.json.encode(_WearerFile(metadata.stature_m))
        files.append(McapAttachment(WEARER, _JSON, wearer))
    pictures = {f"{_WHITE}{name}": p for name, p in metadata.white_balance.items()}
    pictures |= {f"{_MODEL}{number}": p for number, p in enumerate(metadata.model)}
    for name, picture in pictures.items():
        files.append(McapAttachment(f"{name}.png", _PNG, _png(picture.pixels)))
        files.append(McapAttachment(f"{name}{_STROKES}.png", _PNG, _png(picture.labels)))
    return files


def metadata_of(attachments: Iterable[McapAttachment], where: str) -> RecordingMetadata:
    """Decodes the attached files; the last of one name wins, unknown files are ignored. Raises InputError or
    ConfigError."""
    files = {attachment.name: attachment.data for attachment in attachments}
    pictures = {
        name.removesuffix(".png"): _labelled_picture(data, files, name, where)
        for name, data in sorted(files.items())[: 2 * _MOST_PICTURES]
        if name.startswith((_WHITE, _MODEL)) and name.endswith(".png") and _STROKES not in name
    }
    return RecordingMetadata(
        _rig(files[RIG], where) if RIG in files else None,
        _stature_m(files[WEARER], where) if WEARER in files else None,
        tuple(attachment for name, attachment in pictures.items() if name.startswith(_MODEL)),
        {name.removeprefix(_WHITE): p for name, p in pictures.items() if name.startswith(_WHITE)},
    )


def _rig(data: bytes, where: str) -> Rig:
    try:
        entries = decode_json(data, _RigFile).cameras
    except MalformedError as error:
        raise _damaged_error(RIG, error, where) from None
    rig = Rig(tuple(camera_from_dict(entry, f"{where}, {RIG}") for entry in entries))
    if not rig.cameras or len(set(rig.names)) != len(rig.names):
        raise ConfigError("has no cameras, or two of one name", f"{where}, {RIG}", "record again")
    require_plausible(rig, f"{where}, {RIG}")
    return rig


def _stature_m(data: bytes, where: str) -> float:
    try:
        return finite_number(decode_json(data, _WearerFile).stature_m, *STATURES_M)
    except MalformedError as error:
        raise _damaged_error(WEARER, error, where) from None


def _labelled_picture(
    data: bytes, files: Mapping[str, bytes], name: str, where: str
) -> LabelledPicture:
    strokes = f"{name.removesuffix('.png')}{_STROKES}.png"
    try:
        pixels = decode_picture(data, cv2.IMREAD_COLOR, most_pixels=MOST_DRAWN_PIXELS)
        size_px = pixels.shape[1], pixels.shape[0]
        labels = decode_picture(files.get(strokes, b""), cv2.IMREAD_GRAYSCALE, size_px)
        if labels.max() > _COLOURS:
            raise MalformedError(f"contains the id {labels.max()}")
    except MalformedError as error:
        raise _damaged_error(name, error, where) from None
    return LabelledPicture(pixels, labels)


def _damaged_error(name: str, error: MalformedError, where: str) -> InputError:
    return InputError(f"{name} in it: {error.what}", where, "record again")


def _png(pixels: Bytes) -> bytes:
    return bytes(cv2.imencode(".png", pixels)[1])
