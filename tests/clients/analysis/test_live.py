"""A live session: frames come, stop, were never there, or are another version's."""

from itertools import count

from mocapd_analysis.live.feed import LiveFeed
from tests.outputs import recorded
from tests.outputs.frames import eventually, free_port
from tests.outputs.zenoh_pair import running_sink


def test_without_a_daemon_it_waits_and_says_so() -> None:
    feed = LiveFeed(f"tcp/127.0.0.1:{free_port()}", 0)
    feed.start()
    try:
        assert eventually(lambda: "no mocapd" in feed.moment().status)
        assert feed.moment().sessions == ()
    finally:
        feed.stop()


def test_frames_become_a_session_and_their_end_is_said() -> None:
    with running_sink() as running:
        feed = LiveFeed(running.endpoint, 0)
        feed.start()
        try:
            running.heard()
            frames = (recorded.frame_at(n / 30.0, n) for n in count())

            def is_measured() -> bool:
                running.sink.send(next(frames))
                shown = feed.moment().sessions
                return bool(shown) and len(shown[0].session.times_s) > 3

            assert eventually(is_measured)
            assert "live from" in feed.moment().status
            assert eventually(lambda: "no frame for" in feed.moment().status)
            assert feed.moment().sessions  # what came is still there
        finally:
            feed.stop()
