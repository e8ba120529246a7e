"""A recording with pictures as the origin of its cameras; it contains rig, wearer and colours."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import chain, pairwise
from pathlib import Path

from mocapd.boundary.mcap_records import McapAttachment, McapFile
from mocapd.capture.base import Source
from mocapd.capture.file import FASTEST_HZ, SLOWEST_HZ, check_size
from mocapd.capture.frame_groups import as_set
from mocapd.capture.origin import split_address
from mocapd.capture.recording.mcap_source import McapSource, is_picture, pictures
from mocapd.capture.recording.recorded_picture import camera_of
from mocapd.capture.recording.recording_metadata import RecordingMetadata, metadata_of
from mocapd.capture.source_request import SourceRequest
from mocapd.clock import NS_PER_S
from mocapd.errors import ConfigError, InputError
from mocapd.types import Frame, FrameSet, LabelledPicture, Rig

_RECORD = "record with `mocapd record --pictures`, from a daemon whose cameras are calibrated"


@dataclass(frozen=True, slots=True, eq=False)
class McapOrigin:
    """See Origin. `start_ns`: Unix time of the first picture; counts: number of pictures by camera."""

    path: Path
    metadata: RecordingMetadata
    rig: Rig
    start_ns: int
    fps_hz: float
    counts: Mapping[str, int]

    @property
    def rig_source(self) -> str:
        return str(self.path)

    @property
    def stature_m(self) -> float | None:
        return self.metadata.stature_m

    @property
    def count(self) -> int:
        return max(self.counts.values())

    def model(self) -> tuple[LabelledPicture, ...]:
        return self.metadata.model

    def white_balance(self) -> Mapping[str, LabelledPicture]:
        return self.metadata.white_balance

    def frame_sets(self) -> Iterator[FrameSet]:
        """See Origin. A set ends before the second picture of a camera, or half a period after its first picture."""
        order = {camera.name: camera for camera in self.rig.cameras}
        longest_ns = round(0.5 * NS_PER_S / self.fps_hz)
        held: dict[str, Frame] = {}
        for frame in pictures(self.path, self.rig, self.start_ns):
            first_ns = min((picture.t_ns for picture in held.values()), default=frame.t_ns)
            if held and (frame.camera in held or frame.t_ns - first_ns > longest_ns):
                yield as_set({name: held[name] for name in order if name in held})
                held = {}
            held[frame.camera] = frame
        if held:
            yield as_set({name: held[name] for name in order if name in held})

    def source(self, address: str, request: SourceRequest) -> Source:
        """See Origin. The only camera is meant when an address names none."""
        camera = split_address(address)[1]
        cameras = {camera.name: camera for camera in self.rig.cameras if camera.name in self.counts}
        if not camera and len(cameras) == 1:
            camera = next(iter(cameras))
        if camera not in cameras:
            raise ConfigError(
                f"there is no camera {camera!r}" if camera else "several cameras are in it",
                str(self.path),
                f"say which: {self.path}#NAME with one of {', '.join(cameras)}",
            )
        name = request.name or camera
        check_size(str(self.path), name, cameras[camera].size_px, request.size_px)
        return McapSource(name, self.path, cameras[camera], self.start_ns, request.pace)


def open_recording(path: Path) -> McapOrigin:
    """Reads the metadata and the times of all pictures. Raises InputError or ConfigError."""
    file, place = McapFile(path), str(path)
    attachments: list[McapAttachment] = []
    times: dict[str, list[int]] = {}
    for item in file.items(is_picture):
        if isinstance(item, McapAttachment):
            attachments.append(item)
        else:
            times.setdefault(camera_of(item.topic), []).append(item.log_ns)
    metadata = metadata_of(attachments, place)
    if not times:
        raise InputError("holds no pictures of cameras", place, _RECORD)
    if metadata.rig is None:
        raise InputError("does not know where its cameras stood", place, _RECORD)
    strangers = set(times) - set(metadata.rig.names)
    if strangers:
        raise InputError(f"its rig has no camera {min(strangers)!r}", place, _RECORD)
    counts = {name: len(times[name]) for name in metadata.rig.names if name in times}
    return McapOrigin(
        path, metadata, metadata.rig, min(chain(*times.values())), _rate_hz(times), counts
    )


def _rate_hz(times: Mapping[str, list[int]]) -> float:
    """The common rate of the cameras: by the median distance of one's pictures."""
    longest = max(times.values(), key=lambda stamps: len(stamps))  # noqa: PLW0108
    steps = sorted(after - before for before, after in pairwise(sorted(longest)))
    if not steps:
        return 30.0
    return min(FASTEST_HZ, max(SLOWEST_HZ, NS_PER_S / max(1, steps[len(steps) // 2])))
