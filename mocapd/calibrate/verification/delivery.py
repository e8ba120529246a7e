"""Judges how a camera's frames arrive, and names who loses them: this machine, the camera and its link, or the light."""

from dataclasses import dataclass
from enum import StrEnum

from mocapd.capture.camera_link import CameraLink

GOOD_DROPPED, BAD_DROPPED = 0.05, 0.2  # share of a camera's frames
GOOD_RATE = 0.9  # of the requested rate


class Grade(StrEnum):
    """How reliable a result is."""

    GOOD = "good"
    DOUBTFUL = "doubtful"
    BAD = "bad"


def grade(value: float, good: float, bad: float) -> Grade:
    """GOOD up to `good`, DOUBTFUL up to `bad`, BAD beyond and for NaN."""
    if value <= good:
        return Grade.GOOD
    return Grade.DOUBTFUL if value <= bad else Grade.BAD


@dataclass(frozen=True, slots=True)
class Delivery:
    """A camera's frames during some seconds, its rate and the requested rate.

    lost: before they reached this program; late: arrived after their frame set; slow: why this machine is too slow, and
    a remedy; then the machine, not the camera, is the cause of both."""

    received: int
    lost: int
    rate_hz: float
    asked_hz: float
    link: CameraLink
    late: int = 0
    slow: tuple[str, str] | None = None

    @property
    def dropped_share(self) -> float:
        """Share of frames that never arrived."""
        return self.lost / max(self.received + self.lost, 1)

    @property
    def too_late(self) -> float:
        """Share of frames that arrived too late."""
        return self.late / max(self.received + self.lost, 1)


_LOWER = "more light, a shorter exposure, or a lower mode in the step Cameras"
_LOST_FIX = {
    CameraLink.USB: "the camera or its USB bus loses them: use another USB port, without a hub",
    CameraLink.DEVICE: "the camera or its driver loses them: take a lower mode in the step Cameras",
    CameraLink.NETWORK: "the camera or its network loses them: use a better connection, or set the camera to a lower rate",
    CameraLink.PLAYER: "close other programs, or use a faster machine",
}
_RATE_FIX = {
    CameraLink.USB: _LOWER,
    CameraLink.DEVICE: _LOWER,
    CameraLink.NETWORK: "set the rate in the camera's own settings, give it more light, or use a better connection",
    CameraLink.PLAYER: "close other programs, or set fps_hz to the rate of the recording",
}
_LATE_FIX = "give all cameras the same frame rate, and a camera in the network a better connection"


def delivery_judgements(delivery: Delivery) -> list[tuple[Grade, str, str]]:
    """Grade, problem and remedy of each figure. A machine that is too slow reads frames late that came in time."""
    lost = f"{100 * delivery.dropped_share:.0f} % of its frames are lost"
    late = f"{100 * delivery.too_late:.0f} % of its frames come too late"
    rate = f"{delivery.rate_hz:.0f} pictures a second, asked for {delivery.asked_hz:.0f}"
    lost_fix, rate_fix = _LOST_FIX[delivery.link], _RATE_FIX[delivery.link]
    late_fix = _LATE_FIX
    if delivery.slow is not None:
        why, fix = delivery.slow
        lost, late, rate = (f"{text}: this machine is {why}" for text in (lost, late, rate))
        lost_fix = late_fix = rate_fix = fix
    elif delivery.link is CameraLink.PLAYER:
        lost = f"{lost}: this machine is too slow for it"
    is_fast = delivery.rate_hz >= GOOD_RATE * delivery.asked_hz
    return [
        (grade(delivery.dropped_share, GOOD_DROPPED, BAD_DROPPED), lost, lost_fix),
        (grade(delivery.too_late, GOOD_DROPPED, BAD_DROPPED), late, late_fix),
        (Grade.GOOD if is_fast else Grade.DOUBTFUL, rate, rate_fix),
    ]
