"""How a camera's frames arrived during some seconds, for the steps Cameras and Check."""

from mocapd.calibrate.verification.delivery import Delivery
from mocapd.capture.kinds.source_kinds import link_of
from mocapd.pipeline.bundler import CameraCounts
from mocapd.wizard.draft import DraftCamera


def camera_delivery(
    camera: DraftCamera, counts: CameraCounts, rate_hz: float, slow: tuple[str, str] | None
) -> Delivery:
    """counts: of these seconds; rate_hz: measured; slow: see Delivery."""
    return Delivery(
        received=counts.received,
        lost=counts.lost,
        rate_hz=rate_hz,
        asked_hz=camera.fps_hz,
        link=link_of(camera.source),
        late=counts.late,
        slow=slow,
    )
