"""A video file as a kind of source."""

from mocapd.boundary.files import is_file, user_path
from mocapd.capture.base import Source
from mocapd.capture.camera_link import CameraLink
from mocapd.capture.file import FileSource, check_size, probe_video
from mocapd.capture.kinds.source_kind import SourceKind
from mocapd.capture.source_request import SourceRequest


def _matches(address: str) -> bool:
    return is_file(user_path(address))


def _open(address: str, request: SourceRequest) -> Source:
    path = user_path(address)
    name = request.name or path.stem
    info = probe_video(path)
    check_size(str(path), name, info.size_px, request.size_px)
    return FileSource(name, path, info.fps_hz, pace=request.pace, size_px=request.size_px)


FILE = SourceKind(
    form="a video file", link=CameraLink.PLAYER, matches=_matches, open=_open, is_path=True
)
