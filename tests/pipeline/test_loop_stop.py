"""The end of the pipeline's thread while its tracker is in the middle of a step."""

from tests.pipeline.test_loop import Run, WaitingTracker


def test_a_step_that_outlasts_the_stop_publishes_nothing() -> None:
    """By then the next session may use the same outputs."""
    tracker = WaitingTracker()
    run = Run(tracker)
    run.loop.start()
    run.feed()
    assert tracker.entered.acquire(timeout=60.0)
    assert not run.loop.stop(0.05)
    tracker.let_go.release()
    assert run.loop.stop(60.0)
    assert run.out == []
    assert run.loop.metrics().published == 0
