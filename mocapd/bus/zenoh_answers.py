"""Collects answers to a query on the bus, within limits of number and size.

Zenoh's own handler of `get` queues all answers until the timeout: 200 answers of 7 MiB to one query took 1.4 GB. Every
client with permission for the key can send them.
"""

import threading
from typing import Any

import zenoh

MOST_ANSWERS = 1000
MOST_ANSWERS_BYTES = 1_000_000  # of all answers to one query
_SPARE_S = 1.0  # margin, as Zenoh ends a query after its timeout itself


def limited_answers(
    session: zenoh.Session, key: str, timeout_s: float, most_bytes: int, **options: Any
) -> list[zenoh.Sample]:
    """The answers to `key` with at most `most_bytes` each, within the limits above.

    Other answers are dropped. timeout_s: of the query; options: of `session.get`.
    Raises zenoh.ZError.
    """
    answers: list[zenoh.Sample] = []
    left_bytes = MOST_ANSWERS_BYTES
    over = threading.Event()

    def on_reply(reply: zenoh.Reply) -> None:  # on Zenoh's threads, sequentially
        nonlocal left_bytes
        sample = reply.ok
        if sample is None or over.is_set():
            return
        size = len(sample.payload)
        if size <= min(most_bytes, left_bytes) and len(answers) < MOST_ANSWERS:
            left_bytes -= size
            answers.append(sample)

    # indirect=False: Zenoh would start a Python thread that blocks the interpreter's exit
    handler = zenoh.handlers.Callback(on_reply, over.set, indirect=False)
    session.get(key, handler, timeout=timeout_s, **options)
    over.wait(timeout_s + _SPARE_S)
    over.set()
    return answers
