"""What the page needs of the process that serves it: the daemon, or `mocapd calibrate` by itself."""

from typing import Protocol

from mocapd.capture.recording.recording_metadata import RecordingMetadata
from mocapd.pipeline.body_hub import BodySample
from mocapd.pipeline.frame_hub import FrameHub
from mocapd.service.recordings_folder import Recordings
from mocapd.service.service import Snapshot
from mocapd.types import Rig
from mocapd.wizard.wizard import Wizard


class Host(Protocol):
    """Asked by the web server's threads at any time; everything returns at once, but `setup`."""

    @property
    def hub(self) -> FrameHub | None:
        """The cameras' pictures; None while they are being opened anew."""
        ...

    @property
    def rig(self) -> Rig | None:
        """The calibration that is tracked with; None without one."""
        ...

    def known(self) -> RecordingMetadata:
        """What is known of cameras and wearer, for a recording."""
        ...

    @property
    def wizard(self) -> Wizard | None:
        """The setup that is going on; None when there is none."""
        ...

    def setup(self) -> Wizard:
        """The setup, begun when none is going on. Raises UnavailableError when it cannot be now."""
        ...

    def body(self) -> BodySample | None:
        """The newest body; None before the first, or when nothing tracks."""
        ...

    @property
    def recordings(self) -> Recordings | None:
        """What the page records; None where nothing is tracked for long."""
        ...

    def recenter(self) -> None:
        """What the person faces is forward from now on. Raises UnavailableError when nobody is seen."""
        ...

    def snapshot(self) -> Snapshot | None:
        """How cameras, tracker and outputs fare; None when nothing tracks."""
        ...
