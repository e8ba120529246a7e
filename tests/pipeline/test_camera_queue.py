"""Lost frames are bounded by the time that passed, whatever a camera node says of its frame numbers."""

import pytest

from mocapd.pipeline.camera_queue import CameraQueue
from tests.pipeline.free_running import MS, PERIOD_NS, frame

RATE_HZ = 30
MOST_SEQ = 2**53  # a node's stamp holds no more


def lost_of(seqs: list[int], interval_ns: int = PERIOD_NS) -> int:
    queue = CameraQueue("a", PERIOD_NS)
    for k, seq in enumerate(seqs):
        queue.accept(frame("a", seq, k * interval_ns), k * interval_ns)
    return queue.lost


@pytest.mark.parametrize("interval_ns", [PERIOD_NS, 3_333_333])
@pytest.mark.parametrize(
    "seqs",
    [
        [0, MOST_SEQ] * 150,
        [k * 1_000_000 for k in range(300)],
        [k * (MOST_SEQ // 300) for k in range(300)],
    ],
)
def test_invented_frame_numbers_count_for_no_more_than_the_time_allows(
    seqs: list[int], interval_ns: int
) -> None:
    fitting = len(seqs) * (interval_ns / PERIOD_NS + 1)
    assert lost_of(seqs, interval_ns) <= fitting


def test_numbers_that_a_fast_camera_could_send_are_bounded_by_its_rate() -> None:
    ten_seconds = [k * 33 for k in range(10 * RATE_HZ)]  # as of 1000 Hz
    assert lost_of(ten_seconds) <= 10 * 1000 * 1.1


@pytest.mark.parametrize("missing", [1, 5, 600])
def test_a_real_gap_counts_in_full(missing: int) -> None:
    queue = CameraQueue("a", PERIOD_NS)
    for k in (*range(10), *range(10 + missing, 20 + missing)):
        queue.accept(frame("a", k, k * PERIOD_NS), k * PERIOD_NS + 20 * MS)
    assert queue.lost == missing


def test_every_second_frame_of_a_camera_is_lost_and_counted() -> None:
    assert lost_of([2 * k for k in range(100)], 2 * PERIOD_NS) == 99
