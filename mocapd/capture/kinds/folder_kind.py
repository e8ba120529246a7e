"""One camera of a capture folder as a kind of source, and the folder as the origin of its cameras."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from mocapd.boundary.files import is_folder, user_path
from mocapd.capture.base import Source
from mocapd.capture.camera_link import CameraLink
from mocapd.capture.capture_folder import CaptureFolder, folder_source, frame_sets, load_folder
from mocapd.capture.file import check_size
from mocapd.capture.kinds.source_kind import SourceKind
from mocapd.capture.origin import OriginKind, Progress, split_address
from mocapd.capture.source_request import SourceRequest
from mocapd.errors import ConfigError
from mocapd.geometry.rig_file import load_rig
from mocapd.shirt.colour.model_pictures import read_model
from mocapd.shirt.colour.strokes import read_labelled
from mocapd.types import FrameSet, LabelledPicture, Rig


@dataclass(frozen=True, slots=True, eq=False)
class FolderOrigin:
    """See Origin."""

    folder: CaptureFolder

    @property
    def rig(self) -> Rig:
        return self.folder.rig

    @property
    def rig_source(self) -> str:
        return str(self.folder.path / "rig.json")

    @property
    def stature_m(self) -> float | None:
        return self.folder.stature_m

    @property
    def fps_hz(self) -> float:
        return self.folder.fps_hz

    @property
    def count(self) -> int:
        return max(camera.frames for camera in self.folder.cameras)

    def model(self) -> tuple[LabelledPicture, ...]:
        return read_model(self.folder.model)

    def white_balance(self) -> Mapping[str, LabelledPicture]:
        return {c.name: read_labelled(c.scribble) for c in self.folder.cameras if c.scribble}

    def frame_sets(self) -> Iterator[FrameSet]:
        return frame_sets(self.folder)

    def source(self, address: str, request: SourceRequest) -> Source:
        """See Origin. The only camera is meant when an address names none."""
        camera = "" if is_folder(user_path(address)) else split_address(address)[1]
        names = ", ".join(c.name for c in self.folder.cameras)
        place = str(self.folder.path)
        if not camera and len(self.folder.cameras) > 1:
            raise ConfigError(
                f"this folder holds {len(self.folder.cameras)} cameras",
                place,
                f"say which: {place}#NAME with one of {names}",
            )
        for recorded in self.folder.cameras:
            if camera in ("", recorded.name):
                name = request.name or recorded.name
                check_size(str(recorded.video), name, recorded.size_px, request.size_px)
                return folder_source(recorded, request.pace, request.name)
        raise ConfigError(f"there is no camera {camera!r}", place, f"it has {names}")


def _matches(address: str) -> bool:
    path = user_path(address)
    origin, _ = split_address(str(path))
    return is_folder(path) or (bool(origin) and is_folder(Path(origin)))


def _open(address: str, request: SourceRequest) -> Source:
    path = user_path(address)
    folder = path if is_folder(path) else Path(split_address(str(path))[0])
    return FolderOrigin(load_folder(folder)).source(address, request)


def _cameras(origin: str) -> tuple[str, ...]:
    return load_rig(user_path(origin) / "rig.json").names


def _open_origin(origin: str, _cache_dir: Path, _progress: Progress) -> FolderOrigin:
    return FolderOrigin(load_folder(user_path(origin)))


FOLDER = SourceKind(
    form="FOLDER#camN of a capture folder",
    link=CameraLink.PLAYER,
    matches=_matches,
    open=_open,
    is_path=True,
    origin=OriginKind(_cameras, _open_origin),
)
