"""`python -m tests.load.sending ENDPOINT RATE_HZ INSTANCE...`: a stream of skeletons for each instance, each a sink as in
the daemon that joined a router. Frames are made before, so that what is measured is the sending."""

import sys
import threading
import time
from contextlib import ExitStack

import msgspec

from lab.bench_outputs import moving_frames
from mocapd.clock import monotonic_ns
from mocapd.outputs.zenoh.zenoh_config import Params
from mocapd.outputs.zenoh.zenoh_sink import ZenohSink

FRAMES = 64


def main() -> None:
    """Until stdin ends."""
    endpoint, rate_hz, *instances = sys.argv[1:]
    frames = moving_frames(FRAMES)
    ended = threading.Event()
    threading.Thread(target=_wait_for_end, args=(ended,), daemon=True).start()
    with ExitStack() as opened:
        sinks = []
        for instance in instances:
            sink = ZenohSink(Params(connect=(endpoint,), connect_timeout_s=20.0), instance)
            opened.callback(sink.close)
            sink.open()
            sinks.append(sink)
        print("ready", flush=True)
        period_s = 1.0 / float(rate_hz)
        begin_s = time.monotonic()
        seq = 0
        while not ended.is_set():
            for i, sink in enumerate(sinks):
                # spread over the period, as streams of different rooms are
                due_s = begin_s + (seq + i / len(sinks)) * period_s
                time.sleep(max(0.0, due_s - time.monotonic()))
                frame = frames[seq % FRAMES]
                now_ns = monotonic_ns()
                sink.send(msgspec.structs.replace(frame, seq=seq, publish_monotonic_ns=now_ns))
            seq += 1


def _wait_for_end(ended: threading.Event) -> None:
    sys.stdin.read()
    ended.set()


if __name__ == "__main__":
    main()
