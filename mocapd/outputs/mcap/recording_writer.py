"""Writes one recording: frames, state, pictures and what is known, in chunks that reach the disk twice a second.

A process that is killed loses the chunk it was filling, half a second; a machine that loses its power what the
system had not yet written, about FSYNC_S. The times of log are capture times, so that frames and pictures of one
instant lie beside each other in every viewer.
"""

import os
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType

import msgspec
from mcap.writer import CompressionType, IndexType, Writer

import mocapd
from mocapd.boundary.mcap_records import McapAttachment
from mocapd.capture.recording.recorded_picture import (
    IMAGE,
    CompressedImage,
    Time,
    camera_frame,
    image_topic,
)
from mocapd.capture.recording.recording_metadata import RecordingMetadata, attachments_of
from mocapd.clock import NS_PER_S
from mocapd.errors import CannotCreateError, mend_of
from mocapd.output_file import OutputFile, kind_by_magic
from mocapd.outputs import schemas, wire
from mocapd.outputs.mcap import foxglove_messages, foxglove_scene
from mocapd.outputs.mcap.packed_frame import PACKED, PackedFrame, encode_packed, pack
from mocapd.outputs.messages import CalibrationInfo, RestSkeleton, subject
from mocapd.outputs.wire import SkeletonFrame

FLUSH_NS = NS_PER_S // 2  # of a chunk at most: what a kill may cost
FSYNC_NS = 5 * NS_PER_S  # between two waits for the disk itself
CHUNK_BYTES = 4 << 20  # before it is compressed; pictures fill it sooner
_RECORDING = kind_by_magic("a recording", b"\x89MCAP0\r\n")
_JSONSCHEMA = "jsonschema"


@dataclass(frozen=True, slots=True)
class RecordingParams:
    """exact: frames as the bytes that were published, 460 MB an hour at 60 Hz, instead of packed (packed_frame);
    foxglove_hz: how often bones are told in Foxglove's words too [Hz], 0: never; private: nobody else may read it; force:
    replace a file that is there."""

    exact: bool = False
    foxglove_hz: float = 10.0
    private: bool = False
    force: bool = False


class RecordingWriter:
    """Used by one thread. Times are Unix time [ns], apart from those called `now_ns`, of any clock."""

    def __init__(self, path: Path, params: RecordingParams, now_ns: int) -> None:
        """Make the file. Raises CannotCreateError; without force a recording that is there stays."""
        self.path, self._params = path, params
        OutputFile(path, _RECORDING, params.force, option="").check_replaceable()
        mode = 0o600 if params.private else 0o666
        try:
            if params.force:
                path.unlink(missing_ok=True)
            self._descriptor = os.open(
                path, os.O_RDWR | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, mode
            )
        except OSError as error:
            raise CannotCreateError(
                f"cannot be written ({error.strerror})",
                str(path),
                mend_of(error, "choose another name or place"),
            ) from None
        self._file = os.fdopen(self._descriptor, "wb")
        self._mcap = Writer(
            self._file,
            chunk_size=CHUNK_BYTES,
            compression=CompressionType.ZSTD,
            index_types=IndexType.ALL,
        )
        with (
            self._writing()
        ):  # at once, so that a kill within the first moment leaves a recording, if an empty one
            self._mcap.start("", f"mocapd {mocapd.__version__}")
            self._file.flush()
        self._channels: dict[tuple[str, str], int] = {}
        self._schemas: dict[str, int] = {}
        self._rests: dict[int, RestSkeleton] = {}
        self._told: dict[tuple[str, str], RestSkeleton | CalibrationInfo] = {}
        self._scene_due_ns: dict[int, int] = {}
        self._flushed_ns = self._synced_ns = now_ns
        self.frames = self.pictures = 0
        self.bytes = 0

    def __enter__(self) -> "RecordingWriter":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    # -- what is written ---------------------------------------------------------------------------

    def frame(self, frame: SkeletonFrame, published: bytes | None = None, mime: str = "") -> None:
        """One frame; `published`: its bytes on the wire, of this mime type, where they are to be kept."""
        log_ns = frame.capture_unix_ns
        rest = self._rests.get(frame.person)
        names = rest.names if rest is not None else ()
        packed: PackedFrame | None = None
        if not self._params.exact and (rest is not None or not frame.joints):
            packed = pack(frame, names)
        topic = f"/mocapd/skeleton/{frame.person}"
        if packed is not None:
            self._add(topic, PACKED, "msgpack", encode_packed(packed), log_ns, frame.seq)
        else:
            encoding = "json" if mime == wire.JSON_MIME else "msgpack"
            data = published if published is not None else wire.encode_msgpack(frame)
            self._add(topic, wire.SCHEMA, encoding, data, log_ns, frame.seq)
        self.frames += 1
        if rest is not None and self._params.foxglove_hz > 0:
            self._show(frame, rest)

    def _show(self, frame: SkeletonFrame, rest: RestSkeleton) -> None:
        """The same for Foxglove, where it is due."""
        time_ns, due_ns = frame.capture_unix_ns, self._scene_due_ns.get(frame.person, 0)
        period_ns = round(NS_PER_S / self._params.foxglove_hz)
        if time_ns < due_ns and due_ns - time_ns <= period_ns:
            return
        transforms = foxglove_scene.bone_transforms(frame, rest)
        if transforms is not None:
            late = 0 <= time_ns - due_ns < period_ns
            self._scene_due_ns[frame.person] = (due_ns if late else time_ns) + period_ns
            topic, name = f"/tf/person{frame.person}", foxglove_messages.TRANSFORMS
            self._add(topic, name, "json", msgspec.json.encode(transforms), time_ns)

    def tell(self, message: RestSkeleton | CalibrationInfo, unix_ns: int) -> None:
        """A rest skeleton or calibration; one that was told before alike is left out."""
        about = subject(message)
        if self._told.get(about) == message:
            return
        self._told[about] = message
        data = msgspec.msgpack.encode(message)
        if isinstance(message, RestSkeleton):
            self._rests[message.person] = message
            topic = f"/mocapd/rest_skeleton/{message.person}"
            self._add(topic, message.schema, "msgpack", data, unix_ns)
            scene = foxglove_scene.bone_scene(message, unix_ns)
            topic, data = f"/bones/person{message.person}", msgspec.json.encode(scene)
            self._add(topic, foxglove_messages.SCENE, "json", data, unix_ns)
        else:
            self._add("/mocapd/calibration", message.schema, "msgpack", data, unix_ns)
            self._tell_cameras(message, unix_ns)

    def _tell_cameras(self, calibration: CalibrationInfo, unix_ns: int) -> None:
        fixed = foxglove_scene.fixed_transforms(calibration, unix_ns)
        data = msgspec.json.encode(fixed)
        self._add("/tf/fixed", foxglove_messages.TRANSFORMS, "json", data, unix_ns)
        for name, lens in foxglove_scene.lens_messages(calibration, unix_ns).items():
            topic, data = f"/camera/{name}/calibration", msgspec.json.encode(lens)
            self._add(topic, foxglove_messages.CAMERA_CALIBRATION, "json", data, unix_ns)

    def picture(self, camera: str, seq: int, unix_ns: int, jpeg: bytes) -> None:
        """One picture as its camera delivered it, at the middle of its exposure."""
        message = CompressedImage(Time.of(unix_ns), camera_frame(camera), jpeg)
        data = msgspec.json.encode(message)
        self._add(image_topic(camera), IMAGE, "json", data, unix_ns, seq)
        self.pictures += 1

    def attach(self, known: RecordingMetadata, unix_ns: int) -> None:
        """What is known of cameras and wearer."""
        for one in attachments_of(known):
            self.attach_file(one, unix_ns)

    def attach_file(self, file: McapAttachment, unix_ns: int) -> None:
        """A file as it is."""
        with self._writing():
            self._mcap.add_attachment(unix_ns, unix_ns, file.name, file.media_type, file.data)

    # -- the file ----------------------------------------------------------------------------------

    def beat(self, now_ns: int) -> None:
        """Let the file have what was written, where it is time; call it often. Raises CannotCreateError."""
        if now_ns - self._flushed_ns < FLUSH_NS:
            return
        self._flushed_ns = now_ns
        with self._writing():
            self._mcap.flush()
            self.bytes = self._file.tell()
            if now_ns - self._synced_ns >= FSYNC_NS:
                self._synced_ns = now_ns
                os.fdatasync(self._descriptor)

    def close(self) -> None:
        """With its index; may be called twice. Raises CannotCreateError."""
        if self._file.closed:
            return
        with self._writing():
            self._mcap.finish()
            self._file.flush()
            self.bytes = self._file.tell()
            os.fsync(self._descriptor)
            self._file.close()

    def _add(
        self, topic: str, schema: str, encoding: str, data: bytes, unix_ns: int, seq: int = 0
    ) -> None:
        channel = self._channels.get((topic, schema))
        if channel is None:
            channel = self._channels[topic, schema] = self._mcap.register_channel(
                topic, encoding, self._schema(schema)
            )
        log_ns = max(0, unix_ns)
        with self._writing():
            self._mcap.add_message(channel, log_ns, data, log_ns, seq & 0xFFFFFFFF)

    def _schema(self, name: str) -> int:
        known = self._schemas.get(name)
        if known is None:
            data = (
                foxglove_messages.foxglove_schema(name)
                if name in foxglove_messages.FOXGLOVE
                else schema_of(name)
            )
            known = self._schemas[name] = self._mcap.register_schema(name, _JSONSCHEMA, data)
        return known

    def _writing(self) -> "_Writing":
        return _Writing(self.path)


def schema_of(name: str) -> bytes:
    """The JSON schema of a message of ours, that of packed frames among them."""
    if name == PACKED:
        return msgspec.json.encode(msgspec.json.schema(PackedFrame))
    return schemas.schema_json(name)


@dataclass(frozen=True, slots=True)
class _Writing:
    """A disk that is full, or gone, by its name."""

    path: Path

    def __enter__(self) -> None:
        pass

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        if isinstance(error, OSError):
            raise CannotCreateError(
                f"cannot be written any further ({error.strerror})",
                str(self.path),
                "make room; what was written before can be read",
            ) from None
