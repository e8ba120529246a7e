"""One camera of a recording with pictures as a kind of source, and the recording as the origin of its cameras."""

from pathlib import Path
from typing import TYPE_CHECKING

from mocapd.boundary.files import is_file, user_path
from mocapd.capture.base import Source
from mocapd.capture.camera_link import CameraLink
from mocapd.capture.kinds.source_kind import SourceKind
from mocapd.capture.origin import OriginKind, Progress, split_address
from mocapd.capture.source_request import SourceRequest

if TYPE_CHECKING:
    from mocapd.capture.recording.mcap_origin import McapOrigin

_SUFFIX = ".mcap"


def _file(address: str) -> Path:
    """The recording that an address means, whether it names a camera or not."""
    path = user_path(address)
    return path if path.suffix == _SUFFIX else Path(split_address(str(path))[0])


def _matches(address: str) -> bool:
    path = _file(address)
    return path.suffix == _SUFFIX and is_file(path)


def _recording(address: str) -> "McapOrigin":
    # imported here: no start with webcams needs its libraries
    from mocapd.capture.recording.mcap_origin import open_recording

    return open_recording(_file(address))


def _open(address: str, request: SourceRequest) -> Source:
    return _recording(address).source(address, request)


def _cameras(origin: str) -> tuple[str, ...]:
    return tuple(_recording(origin).counts)


def _open_origin(origin: str, _cache_dir: Path, _progress: Progress) -> "McapOrigin":
    return _recording(origin)


RECORDING = SourceKind(
    form="FILE.mcap#camN of a recording with pictures",
    link=CameraLink.PLAYER,
    matches=_matches,
    open=_open,
    is_path=True,
    origin=OriginKind(_cameras, _open_origin),
)
