"""Answers to a question on the bus, measured before they are kept.

Zenoh's own handler of `get` queues whatever comes until the time is over: 200 answers of 7 MiB to one question took
1.4 GB. Anybody whom the key's access control lets answer may send them.
"""

import threading
from typing import Any

import zenoh

MOST_ANSWERS = 1000
MOST_ANSWERS_BYTES = 1_000_000  # of one question, together
_SPARE_S = 1.0  # Zenoh ends a question after its time-out by itself


def limited_answers(
    session: zenoh.Session, key: str, timeout_s: float, most_bytes: int, **options: Any
) -> list[zenoh.Sample]:
    """The answers to `key` that have at most `most_bytes` each, while they are within the limits above.

    Others are dropped. timeout_s: how long to wait for all who take the key; options: as of `session.get`.
    Raises zenoh.ZError.
    """
    kept: list[zenoh.Sample] = []
    left_bytes = MOST_ANSWERS_BYTES
    over = threading.Event()

    def came(reply: zenoh.Reply) -> None:  # on Zenoh's threads, one after the other
        nonlocal left_bytes
        sample = reply.ok
        if sample is None or over.is_set():
            return
        size = len(sample.payload)
        if size <= min(most_bytes, left_bytes) and len(kept) < MOST_ANSWERS:
            left_bytes -= size
            kept.append(sample)

    # on Zenoh's own thread: the Python thread it would else start hinders the interpreter's exit
    handler = zenoh.handlers.Callback(came, over.set, indirect=False)
    session.get(key, handler, timeout=timeout_s, **options)
    over.wait(timeout_s + _SPARE_S)
    over.set()
    return kept
