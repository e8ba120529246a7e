"""Recordings of others: any numbers in frames and rest skeletons, played to every output."""

import itertools
import math
import socket
from pathlib import Path
from random import Random

import msgspec
from mcap.writer import CompressionType, Writer

from mocapd.app.recordings.replay_run import Replay, ReplayParams
from mocapd.outputs.base import SinkStatus
from mocapd.outputs.mcap.packed_frame import PACKED, encode_packed, pack
from mocapd.outputs.mcap.recording_reader import RecordingReader
from mocapd.outputs.messages import REST_SKELETON, StateMessage
from mocapd.outputs.osc.osc_sink import OscSink
from mocapd.outputs.osc.osc_sink import Params as OscParams
from mocapd.outputs.vmc.vmc_params import Params as VmcParams
from mocapd.outputs.vmc.vmc_sink import VmcSink
from mocapd.outputs.vmt.vmt_sink import Params as VmtParams
from mocapd.outputs.vmt.vmt_sink import VmtSink
from mocapd.outputs.vrchat.vrchat_sink import Params as VrchatParams
from mocapd.outputs.vrchat.vrchat_sink import VRChatSink
from mocapd.outputs.wire import SCHEMA, SkeletonFrame
from tests.fuzz.mutations import JSON_VALUES, damaged, mistyped
from tests.fuzz.network import own_ports
from tests.fuzz.row import Attempt, Place, WrongError
from tests.outputs.recorded import frame_at, rest

_VALUES = (
    *JSON_VALUES, "1e300", "-1e39", "3.5e38", "1e6", "-1e6", "1.0000001e6", "2147483647", "2147483648", "4294967296",
    "-9223372036854775808", "9223372036854775807", "18446744073709551615", "-0.0", "5e-324",
)  # fmt: skip
_JUMP_NS = 10**12  # of the clock at each look: nothing is waited for
_MOST = 1e6


class _Checked:
    """A sink that takes only what every receiver can."""

    name = "checked"

    def open(self) -> None:
        """Nothing to open."""

    def send(self, frame: SkeletonFrame) -> None:
        for joint in frame.joints.values():
            u = 0.0 if joint.u is None else joint.u
            if not all(abs(one) <= _MOST for one in (*joint.p, *joint.r, *joint.l, joint.c, u)):
                raise WrongError(f"a joint {joint} is sent on")
        if not (0 <= frame.person < 2**31 and math.isfinite(float(frame.capture_unix_ns))):
            raise WrongError("a person or a time that no output can tell is sent on")

    def send_state(self, message: StateMessage) -> None:
        """Checked by who encodes it."""
        msgspec.msgpack.encode(message)

    def status(self) -> SinkStatus:
        return SinkStatus(0, 0, 0, "")

    def close(self) -> None:
        """Nothing to close."""


def frames(place: Place) -> Attempt:
    """A recording of four messages, some of them changed, played as `mocapd replay` does."""
    port = _deaf_port()
    place_to = f"127.0.0.1:{port}"
    sinks = (
        OscSink(OscParams(destinations=(place_to,))),
        VmcSink(VmcParams(destinations=(place_to,))),
        VRChatSink(VrchatParams(destination=place_to)),
        VmtSink(VmtParams(destination=place_to, anchor="headset")),
        _Checked(),
    )
    for sink in sinks:
        sink.open()
    path = place.folder / "foreign.mcap"
    one, packed = frame_at(0.1, 1), pack(frame_at(0.2, 2), rest().names)
    assert packed is not None
    good = (
        (REST_SKELETON, "json", msgspec.json.encode(rest())),
        (SCHEMA, "json", msgspec.json.encode(one)),
        (PACKED, "msgpack", encode_packed(packed)),
        (SCHEMA, "json", msgspec.json.encode(frame_at(0.3, 3))),
    )

    def play() -> bool:
        clock = itertools.count(10**15, _JUMP_NS).__next__
        replay = Replay(RecordingReader(path), sinks, "here", ReplayParams(), clock)
        replay.play_once()
        return replay.place.frames > 0

    _write(path, good)
    if not play():
        raise WrongError("a sound recording is not played")

    def attempt(random: Random, number: int) -> bool:
        changed = []
        for schema, encoding, data in good:
            if random.random() < 0.6:
                text = encoding == "json"
                data = mistyped(random, data, _VALUES) if text else damaged(random, data)
            changed.append((schema, encoding, data))
        _write(path, tuple(changed))
        return play()

    return attempt


_listening: list[socket.socket] = []


def _deaf_port() -> int:
    """A port of this machine on which nobody reads what comes."""
    listener = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    listener.bind(("127.0.0.1", 0))
    _listening.append(listener)
    port: int = listener.getsockname()[1]
    own_ports.add(port)
    return port


def _write(path: Path, messages: tuple[tuple[str, str, bytes], ...]) -> None:
    with path.open("wb") as file:
        writer = Writer(file, compression=CompressionType.NONE)
        writer.start()
        for number, (schema, encoding, data) in enumerate(messages):
            schema_id = writer.register_schema(schema, "jsonschema", b"")
            channel = writer.register_channel(f"/{number}", encoding, schema_id)
            writer.add_message(channel, number, data, number)
        writer.finish()
