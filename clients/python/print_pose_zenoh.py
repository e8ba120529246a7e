"""Print where the left hand is, with Zenoh and any msgpack library, without mocapd. Start `mocapd run` first.

Usage: python print_pose_zenoh.py [ENDPOINT]
"""

import json
import math
import sys
import time

import msgspec  # or any other library that reads msgpack
import zenoh

ENDPOINT = "tcp/127.0.0.1:7447"
KEY = "mocapd/v1/*/skeleton/0"
SCHEMA = "mocapd.Skeleton.v1"
QUIET_S = 2.0  # after which the silence is told [s]
# what garbage raises in msgspec and below
DAMAGED = (msgspec.DecodeError, RecursionError, TypeError, ValueError, LookupError, OverflowError)
LOOK_EVERY_S = 0.002  # so that Ctrl-C is heard [s]


def main() -> int:
    endpoint = sys.argv[1] if len(sys.argv) > 1 else ENDPOINT
    config = {
        "mode": "client",
        "connect": {"endpoints": [endpoint], "timeout_ms": 2000},
        "scouting": {"multicast": {"enabled": False}},
    }
    try:
        session = zenoh.open(zenoh.Config.from_json5(json.dumps(config)))
    except zenoh.ZError:
        print(f"nobody at {endpoint} -- start `mocapd run`", file=sys.stderr)
        return 69
    with session:
        listen(session)
    return 0


def listen(session: zenoh.Session) -> None:
    newest = zenoh.handlers.RingChannel(1)  # a slow program skips frames
    subscriber = session.declare_subscriber(KEY, newest)
    heard_s = time.monotonic()
    while True:
        sample = subscriber.try_recv()
        if sample is not None:
            say(told(sample))
        elif time.monotonic() - heard_s > QUIET_S:
            say(f"no frame for {QUIET_S:.0f} s; they go on when the daemon does")
        else:
            time.sleep(LOOK_EVERY_S)
            continue
        heard_s = time.monotonic()


def told(sample: zenoh.Sample) -> str:
    mime, _, schema = str(sample.encoding).partition(";")
    if schema not in ("", SCHEMA):
        return f"ignored: the daemon speaks {schema}, this program reads {SCHEMA}"
    read = msgspec.json.decode if mime == "application/json" else msgspec.msgpack.decode
    try:
        frame = read(sample.payload.to_bytes())
        seq, joints = int(frame["seq"]), frame["joints"]
        if "leftHand" not in joints:
            return f"{seq:6d}  nobody there"
        x_m, y_m, z_m = joints["leftHand"]["p"]
        if not all(map(math.isfinite, (x_m, y_m, z_m))):
            return f"{seq:6d}  ignored: the position of the left hand is no number"
        confidence = float(joints["leftHand"]["c"])
    except DAMAGED as error:
        return f"ignored: no frame: {error!r:.80}"
    return f"{seq:6d}  left hand {x_m:+.2f} {y_m:+.2f} {z_m:+.2f} m  confidence {confidence:.2f}"


def say(line: str) -> None:
    print(line, flush=True)


if __name__ == "__main__":
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        sys.exit(130)
