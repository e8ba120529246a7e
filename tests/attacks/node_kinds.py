"""What a malicious camera node does, a row for each kind: its pictures, stamps, clock, states, rate."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from random import Random

import msgspec

from mocapd.capture.remote import camera_wire
from mocapd.capture.remote.camera_wire import CameraState, ClockAnswer, PictureStamp
from mocapd.clock import NS_PER_S, monotonic_ns
from tests.fuzz import large_pictures as large
from tests.fuzz.damaged_pictures import jpeg, png, sample

SIZE_PX = (640, 480)
MOST_COUNT = 2**53
_MESSAGE_BYTES = 7 << 20
_DAMAGED_EVERY = 400  # bytes


@cache
def good_pictures() -> tuple[bytes, ...]:
    """Some JPEGs, each another."""
    return tuple(jpeg(sample(SIZE_PX, seed)) for seed in range(8))


def good_picture(number: int) -> bytes:
    """The picture of this number."""
    return good_pictures()[number % len(good_pictures())]


def node_ns() -> int:
    """The honest node's clock: three seconds from ours."""
    return monotonic_ns() + 3 * NS_PER_S


def good_stamp(number: int, run: int) -> PictureStamp:
    """Of a picture that is exposed now."""
    return PictureStamp(run, number, node_ns() - NS_PER_S // 100)


def _encoded_stamp(number: int, run: int) -> bytes:
    return camera_wire.encode(good_stamp(number, run))


def _answer(run: int) -> Sequence[bytes]:
    now_ns = node_ns()
    return [camera_wire.encode(ClockAnswer(run, now_ns, now_ns))]


def _one_state(state: CameraState) -> Sequence[bytes]:
    return [camera_wire.encode(state)]


@dataclass(frozen=True)
class NodeKind:
    """picture: file of a number; stamp: of a number and a run, None for none; clock: answers of a run; states: answers,
    from the honest one; flaps: whether its liveliness token comes and goes; reconnects: whether its session does."""

    picture: Callable[[int], bytes] = good_picture
    stamp: Callable[[int, int], bytes | None] = _encoded_stamp
    clock: Callable[[int], Sequence[bytes]] = _answer
    states: Callable[[CameraState], Sequence[bytes]] = _one_state
    rate_hz: float = 30.0
    flaps: bool = False
    reconnects: bool = False


def _seqs(seq: Callable[[int], int]) -> Callable[[int, int], bytes]:
    return lambda number, run: camera_wire.encode(
        PictureStamp(run, seq(number), good_stamp(number, run).exposure_ns)
    )


def _times(off_s: Callable[[int], float]) -> Callable[[int, int], bytes]:
    return lambda number, run: camera_wire.encode(
        PictureStamp(run, number, node_ns() + round(off_s(number) * NS_PER_S))
    )


def _clock(remote_ns: Callable[[int], int]) -> Callable[[int], Sequence[bytes]]:
    def answer(run: int) -> Sequence[bytes]:
        now_ns = remote_ns(node_ns())
        return [camera_wire.encode(ClockAnswer(run, now_ns, now_ns))]

    return answer


def _drifting(share: float) -> NodeKind:
    def remote_ns(now_ns: int) -> int:
        return now_ns + round(share * (now_ns % (3600 * NS_PER_S)))

    def stamp(number: int, run: int) -> bytes:
        return camera_wire.encode(PictureStamp(run, number, remote_ns(node_ns())))

    return NodeKind(stamp=stamp, clock=_clock(remote_ns))


def _with(**fields: object) -> Callable[[CameraState], Sequence[bytes]]:
    return lambda state: [camera_wire.encode(msgspec.structs.replace(state, **fields))]


@cache
def _damaged(number: int) -> bytes:
    """Decoded in part, with a warning of libjpeg."""
    data = bytearray(good_picture(number))
    for at in range(1000, len(data), _DAMAGED_EVERY):
        data[at] = 0x11
    return bytes(data)


@cache
def _png(name: bytes) -> bytes:
    return large.many_chunks(SIZE_PX, 480_000, name)


@cache
def _comments() -> bytes:
    return large.many_segments(SIZE_PX, 2_000_000)


@cache
def _late_comments() -> bytes:
    return large.many_late_segments(SIZE_PX, 1_900_000)


@cache
def _scans() -> bytes:
    return large.many_scans(SIZE_PX, 38_000 // 12, large.short_scan())


@cache
def _few_scans() -> bytes:
    return large.many_scans(SIZE_PX, 50, large.short_scan())


@cache
def _claims() -> bytes:
    data = bytearray(good_picture(0))
    at = data.index(b"\xff\xc0") + 5
    data[at : at + 4] = b"\x7d\x00\x7d\x00"
    return bytes(data)


@cache
def _black() -> bytes:
    return jpeg(sample(SIZE_PX) // 255)


_RANDOM = Random(1)

KINDS: dict[str, NodeKind] = {
    "honest": NodeKind(),
    # numbers, times and clocks
    "seq-0-and-most": NodeKind(stamp=_seqs(lambda n: n % 2 * MOST_COUNT), rate_hz=300.0),
    "seq-random": NodeKind(stamp=_seqs(lambda n: _RANDOM.randrange(MOST_COUNT))),
    "seq-thousands": NodeKind(stamp=_seqs(lambda n: 1_000_000 * n)),
    "runs-change": NodeKind(
        stamp=lambda n, run: _encoded_stamp(n, run + n % 3), clock=lambda run: _answer(run + _RANDOM.randrange(3))
    ),
    "times-within-5-s": NodeKind(stamp=_times(lambda n: _RANDOM.uniform(-5.0, 5.0))),
    "times-within-1-s": NodeKind(stamp=_times(lambda n: _RANDOM.uniform(-1.0, 0.0))),
    "times-stand-still": NodeKind(stamp=lambda n, run: camera_wire.encode(PictureStamp(run, 1, 1))),
    "clock-drifts": _drifting(0.3),
    "clock-drifts-little": _drifting(0.002),
    "clock-jumps": NodeKind(clock=_clock(lambda now_ns: now_ns + _RANDOM.randrange(10) * NS_PER_S)),
    "clock-extreme": NodeKind(clock=_clock(lambda _: _RANDOM.choice((-(2**60), 2**60)))),
    "clock-answers-large": NodeKind(clock=lambda run: [bytes(_MESSAGE_BYTES)]),
    "clock-answers-often": NodeKind(clock=lambda run: [*_answer(run)] * 1000),
    # pictures
    "png-ztxt": NodeKind(picture=lambda n: _png(b"zTXt")),
    "png-time": NodeKind(picture=lambda n: _png(b"tIME")),
    "png": NodeKind(picture=lambda n: png(sample(SIZE_PX, n % 4))),
    "jpeg-comments": NodeKind(picture=lambda n: _comments()),
    "jpeg-late-comments": NodeKind(picture=lambda n: _late_comments()),
    "jpeg-scans": NodeKind(picture=lambda n: _scans()),
    "jpeg-few-scans": NodeKind(picture=lambda n: _few_scans()),
    "jpeg-damaged": NodeKind(picture=_damaged),
    "jpeg-cut": NodeKind(picture=lambda n: good_picture(n)[: 2000 + n % 3000]),
    "jpeg-padded": NodeKind(picture=lambda n: good_picture(n) + bytes(_MESSAGE_BYTES)),
    "other-size": NodeKind(picture=lambda n: jpeg(sample((320, 240), n % 4))),
    "claims-gigapixels": NodeKind(picture=lambda n: _claims()),
    "random-bytes": NodeKind(picture=lambda n: _RANDOM.randbytes(50_000)),
    "no-bytes": NodeKind(picture=lambda n: b""),
    "frozen": NodeKind(picture=lambda n: good_picture(0)),
    "black-now-and-then": NodeKind(picture=lambda n: _black() if n // 65 % 2 else good_picture(n)),
    "now-and-then-damaged": NodeKind(picture=lambda n: b"x" if n // 30 % 20 == 0 else good_picture(n)),
    # rates
    "300-hz": NodeKind(rate_hz=300.0),
    "3000-hz-of-100-kb": NodeKind(picture=lambda n: good_picture(n).ljust(100_000, b"\0"), rate_hz=3000.0),
    # stamps
    "no-stamp": NodeKind(stamp=lambda n, run: None),
    "stamp-random": NodeKind(stamp=lambda n, run: _RANDOM.randbytes(40)),
    "stamp-large": NodeKind(stamp=lambda n, run: bytes(_MESSAGE_BYTES)),
    # states
    "states-large": NodeKind(states=lambda state: [bytes(_MESSAGE_BYTES)] * 200),
    "states-many": NodeKind(states=lambda state: [*_one_state(state)] * 5000),
    "states-random": NodeKind(states=lambda state: [_RANDOM.randbytes(100)]),
    "states-none": NodeKind(states=lambda state: []),
    "state-lost": NodeKind(states=_with(state="lost", reason="\x1b[2J\n\x07" * 20), flaps=True),
    "state-other-size": NodeKind(states=_with(size_px=(65_535, 65_535))),
    "state-settable": NodeKind(states=_with(can_set=True)),
    "flaps": NodeKind(flaps=True),
    "reconnects": NodeKind(reconnects=True),
}  # fmt: skip
