"""What a camera node and a daemon hear of each other: pictures with stamps, their sequences, clocks, states, orders."""

import random as randoms
from contextlib import suppress
from random import Random

import msgspec

from mocapd.calibrate.bump.bump_watch import Mounting
from mocapd.capture.camera_thread.capture_status import CaptureState, CaptureStatus
from mocapd.capture.remote import camera_wire
from mocapd.capture.remote.camera_wire import (
    CameraState,
    ClockAnswer,
    Done,
    LockedControls,
    Order,
    PictureStamp,
)
from mocapd.capture.remote.clock_fit import ClockLine
from mocapd.capture.remote.clock_track import ClockTrack
from mocapd.capture.remote.picture_reader import Arrived, PictureReader
from mocapd.capture.webcam.camera_controls import Control
from mocapd.clock import NS_PER_S
from mocapd.errors import MalformedError
from mocapd.node.node_controls import ControlOrders
from mocapd.outputs.zenoh.zenoh_state import ZenohState
from mocapd.pipeline.bundler import Bundler
from mocapd.pipeline.metrics import CameraMetrics
from mocapd.service.health import camera_message
from mocapd.session.camera_inputs import CameraInput
from tests.fuzz.damaged_pictures import jpeg, sample
from tests.fuzz.mutations import damaged, repeated, shuffled
from tests.fuzz.row import Attempt, Place, WrongError, named
from tests.wizard.fake_webcam import RANGES, FakeWebcam

_SIZE_PX = (64, 48)
_MOST_HZ = 1000  # that a camera could have
_STEADY = Mounting.STEADY
_NOW_NS = 10**12
_CLOCK = ClockLine(_NOW_NS, 3 * 10**9, 5e-5, 1e4, 1e5)
_TIMES = (
    0,
    -1,
    1,
    2**31,
    2**60,
    -(2**60),
    2**60 + 1,
    2**62,
    2**63,
    10**18,
    _NOW_NS,
    _NOW_NS + 3 * 10**9,
)


def pictures(place: Place) -> Attempt:
    """A file and its stamp, one of them damaged: what comes out has the size and a time that can be."""
    good = jpeg(sample(_SIZE_PX))
    stamp = PictureStamp(run=7, seq=1, exposure_ns=_CLOCK.remote_from_local(_NOW_NS))
    PictureReader("a").read(Arrived(good, camera_wire.encode(stamp), _NOW_NS), _SIZE_PX, 7, _CLOCK)

    def attempt(random: Random, number: int) -> bool:
        data, told = good, camera_wire.encode(_another(random, stamp))
        if random.random() < 0.5:
            data = damaged(random, data)
        if random.random() < 0.5:
            told = damaged(random, told)
        if random.random() < 0.05:
            told = repeated(random, told)
        arrived = Arrived(data, told, _NOW_NS)
        frame = PictureReader("a").read(arrived, _SIZE_PX, 7, _CLOCK)
        if frame.pixels.shape != (48, 64, 3) or not 0 <= _NOW_NS - frame.t_ns <= 10**9:
            raise WrongError("a picture of another size or of a time that cannot be")
        return True

    return attempt


def sequences(place: Place) -> Attempt:
    """Pictures whose stamps follow each other in any way: what the daemon says of the camera afterwards can be sent, and
    it counts no more lost pictures than there was time for."""
    good = jpeg(sample(_SIZE_PX))
    camera = CameraInput(FakeWebcam("a"), "zenoh://127.0.0.1/attic/cam0", _SIZE_PX)
    period_ns = NS_PER_S // 30
    honest = [PictureStamp(7, seq, 0) for seq in range(4)]

    def attempt(random: Random, number: int) -> bool:
        reader, bundler = PictureReader("a"), Bundler(("a",))
        now_ns, taken = _NOW_NS, 0
        for stamp in shuffled(random, honest, _with_any_seq, most=200):
            now_ns += random.choice((0, 1, NS_PER_S // 300, period_ns, period_ns, NS_PER_S))
            off_ns = random.choice((0, 0, 0, NS_PER_S // 2, random.randrange(3 * NS_PER_S)))
            exposure_ns = _CLOCK.remote_from_local(now_ns - off_ns)
            stamp = PictureStamp(stamp.run, stamp.seq, exposure_ns)
            arrived = Arrived(good, camera_wire.encode(stamp), now_ns)
            with suppress(MalformedError):
                bundler.add(reader.read(arrived, _SIZE_PX, 7, _CLOCK), now_ns)
                taken += 1
        counts = bundler.counts()["a"]
        gone_s = (now_ns - _NOW_NS) / NS_PER_S + 1.0  # the first may be exposed a second before
        if counts.lost > _MOST_HZ * gone_s + taken:
            raise WrongError(f"{counts.lost} pictures are lost in {gone_s:.1f} s")
        torn = random.choice((0, 2**53, 2**64, 10**30))
        status = CaptureStatus("a", CaptureState.LIVE, "", taken, torn, 0, 30.0, now_ns)
        message = camera_message("pc", camera, status, CameraMetrics(30.0, counts), _STEADY)
        for message_format in ("json", "msgpack"):
            ZenohState("pc", message_format).set(message)
        return taken > 0

    return attempt


def _with_any_seq(random: Random, stamp: PictureStamp) -> PictureStamp:
    seq = random.choice((0, 1, 10**6, 2**31, 2**53, random.randrange(2**53)))
    return PictureStamp(random.choice((7, 7, 7, 8)), seq, stamp.exposure_ns)


def clocks(place: Place) -> Attempt:
    """Answers to the question what time it is: whatever they say, there is a line, and it can be asked."""

    def attempt(random: Random, number: int) -> bool:
        track, told = ClockTrack(), 0
        for i in range(1 + random.randrange(12)):
            asked_ns = _NOW_NS + i * random.choice((0, 1, 10**6, 10**9, 10**12))
            came_ns = asked_ns + random.choice((0, 1, 10**5, 10**8, 10**10))
            taken_ns = random.choice((asked_ns + 3 * 10**9, random.choice(_TIMES)))
            answer = ClockAnswer(7, taken_ns, taken_ns + random.choice((0, 10, -1, 10**9, 2**60)))
            data = camera_wire.encode(answer)
            if random.random() < 0.2:
                data = damaged(random, data)

            def take(data: bytes = data, asked: int = asked_ns, came: int = came_ns) -> None:
                track.add_answer(asked, camera_wire.decode(data, ClockAnswer), came)

            told += named(take)
            if track.line is not None:
                for t_ns in _TIMES:
                    track.line.remote_from_local(track.line.local_from_remote(t_ns))
        return bool(told)

    return attempt


def states(place: Place) -> Attempt:
    """What a node says of a camera, and of an order."""
    goods: tuple[msgspec.Struct, ...] = (
        CameraState("attic", "left", "lost", "was unplugged", _SIZE_PX, 30.0, True, 7),
        Done(3, (0, 255, 1), "no"),
    )
    for good in goods:
        camera_wire.decode(camera_wire.encode(good), type(good))

    def attempt(random: Random, number: int) -> bool:
        good = random.choice(goods)
        camera_wire.decode(damaged(random, camera_wire.encode(good)), type(good))
        return True

    return attempt


def orders(place: Place) -> Attempt:
    """Orders to a webcam: it is never set to what it does not take, and each is answered."""
    goods = [
        Order("write", Control.GAIN, 99),
        Order("read", Control.EXPOSURE),
        Order("range", Control.FOCUS),
        Order("keep", kept=LockedControls(exposure=20, gain=8, power_line_hz=50)),
    ]
    if ControlOrders(FakeWebcam("a")).done(camera_wire.encode(goods[0])).value != 99:
        raise WrongError("a good order is not followed")

    def attempt(random: Random, number: int) -> bool:
        webcam = FakeWebcam("a")
        order = camera_wire.encode(_another(random, random.choice(goods)))
        done = ControlOrders(webcam).done(damaged(random, order) if number % 2 else order)
        for control, value in webcam.values.items():
            if not RANGES[control].low <= value <= RANGES[control].high:
                raise WrongError(f"{control} is {value}")
        return not done.trouble

    return attempt


def _another(random: randoms.Random, message: msgspec.Struct) -> msgspec.Struct:
    """With another number somewhere, now and then."""
    names = [name for name in message.__struct_fields__ if isinstance(getattr(message, name), int)]
    if not names or random.random() < 0.5:
        return message
    value = random.choice((*_TIMES, 256, -1))
    fits = -(2**63) <= value < 2**64
    return msgspec.structs.replace(message, **{random.choice(names): value if fits else 0})
