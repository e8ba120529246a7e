"""The page's interface to the process that serves it: the daemon, or `mocapd calibrate` alone."""

from typing import Protocol

from mocapd.capture.recording.recording_metadata import RecordingMetadata
from mocapd.pipeline.body_hub import BodySample
from mocapd.pipeline.frame_hub import FrameHub
from mocapd.service.recordings_folder import Recordings
from mocapd.service.service import Snapshot
from mocapd.types import Rig
from mocapd.wizard.wizard import Wizard


class Host(Protocol):
    """Called by the web server's threads at any time; everything but `setup` returns at once."""

    @property
    def hub(self) -> FrameHub | None:
        """The cameras' pictures; None while they are being reopened."""
        ...

    @property
    def rig(self) -> Rig | None:
        """The calibration in use; None without one."""
        ...

    def known(self) -> RecordingMetadata:
        """The set-up of cameras and wearer, for a recording."""
        ...

    @property
    def wizard(self) -> Wizard | None:
        """The current setup; None without one."""
        ...

    def setup(self) -> Wizard:
        """The current setup, or a new one. Raises UnavailableError when none can begin now."""
        ...

    def body(self) -> BodySample | None:
        """The newest body; None before the first, or when nothing tracks."""
        ...

    @property
    def recordings(self) -> Recordings | None:
        """The page's recordings; None in a process that does not track continuously."""
        ...

    def recenter(self) -> None:
        """Make the person's facing direction forward. Raises UnavailableError without a person in view."""
        ...

    def snapshot(self) -> Snapshot | None:
        """State of cameras, tracker and outputs; None when nothing tracks."""
        ...
