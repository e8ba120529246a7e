"""Writes one recording: frames, state, pictures and calibration, in chunks that reach the disk twice a second.

A killed process loses its unfinished chunk, half a second. A power cut loses what the system had not written, about
FSYNC_NS. Log times are capture times, so that every viewer shows frames and pictures of one instant together.
"""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

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
from mocapd.errors import CannotCreateError, creation_errors, mend_of
from mocapd.output_file import OutputFile, kind_by_magic
from mocapd.outputs import schemas, wire
from mocapd.outputs.mcap import foxglove_messages, foxglove_scene
from mocapd.outputs.mcap.packed_frame import PACKED, PackedFrame, encode_packed, pack
from mocapd.outputs.messages import CalibrationInfo, RestSkeleton, subject
from mocapd.outputs.wire import SkeletonFrame

FLUSH_NS = NS_PER_S // 2  # longest time of a chunk: the loss at a kill
FSYNC_NS = 5 * NS_PER_S  # between two fdatasync calls
CHUNK_BYTES = 4 << 20  # before compression; pictures fill it before FLUSH_NS
_RECORDING = kind_by_magic("a recording", b"\x89MCAP0\r\n")
_JSONSCHEMA = "jsonschema"


@dataclass(frozen=True, slots=True)
class RecordingParams:
    """exact: write frames as the published bytes, 460 MB an hour at 60 Hz, instead of packed (packed_frame);
    foxglove_hz: rate of bone transforms for Foxglove [Hz], 0: none; private: only this user may read the file;
    force: replace an existing file."""

    exact: bool = False
    foxglove_hz: float = 10.0
    private: bool = False
    force: bool = False


class RecordingWriter:
    """Used by one thread. Times are Unix time [ns], apart from those called `now_ns`, of any clock."""

    def __init__(self, path: Path, params: RecordingParams, now_ns: int) -> None:
        """Create the file. Raises CannotCreateError, without `force` also for an existing recording."""
        self.path, self._params = path, params
        OutputFile(path, _RECORDING, params.force, option="").check_replaceable()
        mode = 0o600 if params.private else 0o666
        with creation_errors(path, "choose another name or place"):
            if params.force:
                path.unlink(missing_ok=True)
            self._descriptor = os.open(
                path, os.O_RDWR | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, mode
            )
        self._file = os.fdopen(self._descriptor, "wb")
        self._mcap = Writer(
            self._file,
            chunk_size=CHUNK_BYTES,
            compression=CompressionType.ZSTD,
            index_types=IndexType.ALL,
        )
        with self._writing():  # at once, so that even an early kill leaves a valid, empty recording
            self._mcap.start("", f"mocapd {mocapd.__version__}")
            self._file.flush()
        self._channels: dict[tuple[str, str, str], int] = {}  # by topic, schema and encoding
        self._schemas: dict[str, int] = {}
        self._rests: dict[int, RestSkeleton] = {}
        self._newest_states: dict[tuple[str, str], RestSkeleton | CalibrationInfo] = {}
        self._scene_due_ns: dict[int, int] = {}
        self._flushed_ns = self._synced_ns = now_ns
        self.frames = self.pictures = 0
        self.bytes = 0

    def __enter__(self) -> "RecordingWriter":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    # -- content -----------------------------------------------------------------------------------

    def frame(self, frame: SkeletonFrame, published: bytes | None = None, mime: str = "") -> None:
        """Add one frame; `published`: its bytes on the wire, of this mime type, for exact recordings."""
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
        """Add the frame's transforms for Foxglove, at foxglove_hz."""
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

    def add_state(self, message: RestSkeleton | CalibrationInfo, unix_ns: int) -> None:
        """Add a rest skeleton or calibration, unless it equals the last one."""
        about = subject(message)
        if self._newest_states.get(about) == message:
            return
        self._newest_states[about] = message
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
            self._add_cameras(message, unix_ns)

    def _add_cameras(self, calibration: CalibrationInfo, unix_ns: int) -> None:
        fixed = foxglove_scene.fixed_transforms(calibration, unix_ns)
        data = msgspec.json.encode(fixed)
        self._add("/tf/fixed", foxglove_messages.TRANSFORMS, "json", data, unix_ns)
        for name, lens in foxglove_scene.lens_messages(calibration, unix_ns).items():
            topic, data = f"/camera/{name}/calibration", msgspec.json.encode(lens)
            self._add(topic, foxglove_messages.CAMERA_CALIBRATION, "json", data, unix_ns)

    def picture(self, camera: str, seq: int, unix_ns: int, jpeg: bytes) -> None:
        """Add one picture as its camera delivered it, at the middle of its exposure."""
        message = CompressedImage(Time.of(unix_ns), camera_frame(camera), jpeg)
        data = msgspec.json.encode(message)
        self._add(image_topic(camera), IMAGE, "json", data, unix_ns, seq)
        self.pictures += 1

    def attach(self, setup: RecordingMetadata, unix_ns: int) -> None:
        """Attach the set-up of cameras and wearer."""
        for file in attachments_of(setup):
            self.attach_file(file, unix_ns)

    def attach_file(self, file: McapAttachment, unix_ns: int) -> None:
        """Attach a file unchanged."""
        with self._writing():
            self._mcap.add_attachment(unix_ns, unix_ns, file.name, file.media_type, file.data)

    # -- the file ----------------------------------------------------------------------------------

    def flush_if_due(self, now_ns: int) -> None:
        """Flush every FLUSH_NS, sync every FSYNC_NS; call it often. Raises CannotCreateError."""
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
        """Write the index and close; may be called twice. Raises CannotCreateError."""
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
        channel = self._channels.get((topic, schema, encoding))
        if channel is None:
            channel = self._channels[topic, schema, encoding] = self._mcap.register_channel(
                topic, encoding, self._schema(schema)
            )
        log_ns = max(0, unix_ns)
        with self._writing():
            self._mcap.add_message(channel, log_ns, data, log_ns, seq & 0xFFFFFFFF)

    def _schema(self, name: str) -> int:
        schema = self._schemas.get(name)
        if schema is None:
            data = (
                foxglove_messages.foxglove_schema(name)
                if name in foxglove_messages.FOXGLOVE
                else schema_of(name)
            )
            schema = self._schemas[name] = self._mcap.register_schema(name, _JSONSCHEMA, data)
        return schema

    @contextmanager
    def _writing(self) -> Iterator[None]:
        """Turns an OSError, such as of a full disk or one that was pulled, into a CannotCreateError with the path."""
        try:
            yield
        except OSError as error:
            raise CannotCreateError(
                f"cannot be written any further ({error.strerror})",
                str(self.path),
                f"{mend_of(error, 'check that disk')}; what was written before can be read",
            ) from None


def schema_of(name: str) -> bytes:
    """The JSON schema of one of our messages, packed frames included."""
    if name == PACKED:
        return msgspec.json.encode(msgspec.json.schema(PackedFrame))
    return schemas.schema_json(name)
