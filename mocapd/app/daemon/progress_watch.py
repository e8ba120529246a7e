"""Whether a daemon gets on: by what it has done, never by the time that has passed. Pure."""

from mocapd.capture.camera_thread.capture_status import CaptureState
from mocapd.service.service import Snapshot


class ProgressWatch:
    """The pipeline has come round, which includes the outputs, and every camera that is there has delivered.

    Without frames the pipeline comes round twice a second by itself, so an empty room and unplugged cameras are no
    standstill; a tracker that does not return, an output that blocks and a camera that counts as live and sends
    nothing are.
    """

    def __init__(self) -> None:
        self._turns = 0
        self._frames: dict[str, int] = {}

    def has_progressed(self, snapshot: Snapshot) -> bool:
        """Whether all of that has happened since this last said so."""
        # compared by difference: another session counts anew
        turned = snapshot.metrics.turns != self._turns
        live = {n: s for n, s in snapshot.cameras.items() if s.state is CaptureState.LIVE}
        delivered = all(self._frames.get(name) != status.frames for name, status in live.items())
        if not (turned and delivered):
            return False
        self._turns = snapshot.metrics.turns
        self._frames = {name: status.frames for name, status in live.items()}
        return True
