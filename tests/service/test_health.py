"""What the daemon says of its cameras."""

import pytest

from mocapd.capture.camera_thread.capture_status import CaptureState, CaptureStatus
from mocapd.pipeline.bundler import CameraCounts
from mocapd.pipeline.metrics import CameraMetrics
from mocapd.service.health import lost_frames


@pytest.mark.parametrize(
    ("gaps", "torn", "lost"),
    [(5, 0, 5), (5, 3, 5), (0, 3, 3)],
    ids=["lost on the way", "three of the gaps are damaged frames", "nothing but damage came"],
)
def test_a_damaged_frame_counts_once_as_lost(gaps: int, torn: int, lost: int) -> None:
    status = CaptureStatus("cam0", CaptureState.LIVE, "", 100, torn, 0, 30.0, None)
    assert lost_frames(CameraMetrics(30.0, CameraCounts(100, 100, 0, gaps)), status) == lost


def test_a_camera_that_the_pipeline_does_not_know_yet_has_its_damage() -> None:
    assert lost_frames(None, CaptureStatus("a", CaptureState.LIVE, "", 9, 2, 0, 30.0, None)) == 2
