"""A host of the page without daemon: cameras whose pictures a test hands in, a body, a step that listens."""

from pathlib import Path
from types import MappingProxyType

import numpy as np

from mocapd.body.shape import mean_shape
from mocapd.body.skeleton import INDEX, joint_positions, standard_skeleton
from mocapd.calibrate.bump.bump_watch import Mounting
from mocapd.capture.camera_thread.capture_status import CaptureState, CaptureStatus
from mocapd.capture.jpeg_picture import JpegPicture
from mocapd.capture.recording.recording_metadata import RecordingMetadata
from mocapd.clock import monotonic_ns
from mocapd.errors import InputError, MocapdError, Problem, UnavailableError
from mocapd.outputs.base import SinkStatus
from mocapd.pipeline.body_hub import BodyHub, BodySample
from mocapd.pipeline.frame_hub import FrameHub
from mocapd.pipeline.latency_histogram import LatencyHistogram
from mocapd.pipeline.metrics import Metrics
from mocapd.pipeline.rolling import Percentiles
from mocapd.pipeline.slowness import Slowness
from mocapd.service.body_recorder import BodyRecorder
from mocapd.service.recordings_folder import Recordings
from mocapd.service.service import Snapshot
from mocapd.trackers.canned.canned_motion import CannedMotion
from mocapd.trackers.canned.tracker import canned_pose
from mocapd.tracking.base import Track
from mocapd.tracking.effort import Effort
from mocapd.types import BodyState, Frame, FrameSet, Rig, Tracking
from mocapd.wizard.commands import Command, Verbs
from mocapd.wizard.context import Context
from mocapd.wizard.step import Shape, StepState, StepView
from mocapd.wizard.step_names import StepName
from mocapd.wizard.wizard import Wizard
from tests.geometry.rigs import ring

BELOW_THE_HIPS = [
    INDEX[side + bone]
    for side in ("left", "right")
    for bone in ("UpperLeg", "LowerLeg", "Foot", "Toes")
]  # as of a tracker of the upper body
OVERLAY = Shape("text", ((10.0, 40.0),), "hint", "seen")


class Said(Command, frozen=True):
    """Something that fits."""

    png: str = ""


class Bad(Said, frozen=True):
    """Something that does not."""


class ListeningStep:
    """Keeps what it is told; `bad` does not fit."""

    name = StepName.CAMERAS
    verbs: Verbs = MappingProxyType({"rename": Said, "strokes": Said, "good": Said, "bad": Bad})

    def __init__(self, context: Context) -> None:
        self.commands: list[Said] = []
        self._names = context.hub.names

    def enter(self) -> None:
        """Nothing to prepare."""

    def tick(self, now_ns: int) -> None:
        """Nothing to do."""

    def command(self, command: Command) -> None:
        assert isinstance(command, Said)
        if isinstance(command, Bad):
            raise InputError("strokes for 3 of 10 colours", "cam0", "paint the others")
        self.commands.append(command)

    def job_failed(self, error: MocapdError) -> None:
        """It has no job."""

    def view(self) -> StepView:
        return StepView(
            StepState.WAITING,
            f"Told {len(self.commands)} times.",
            0.4,
            (Problem("too dark", "cam1", "switch on a lamp"),),
            dict.fromkeys(self._names, (OVERLAY,)),
            {"lengths": [len(one.png) for one in self.commands], "picture": "strokes/1"},
            {"strokes/1": b"\x89PNG and so on"},
        )

    def leave(self) -> None:
        """Nothing to undo."""


class TinyHost:
    """See web.host.Host. `begun` counts the setups; they are stopped by `stop`."""

    def __init__(self, state_dir: Path, cameras: int = 2) -> None:
        self.hub: FrameHub | None = FrameHub(f"cam{i}" for i in range(cameras))
        self.rig: Rig | None = Rig(ring(cameras))
        self.wizard: Wizard | None = None
        self.why_not = ""
        self.begun = self.recentered = 0
        self.bodies = BodyHub()
        self.made: Recordings | None = Recordings(state_dir / "recordings", self._recorder)
        self.mountings: dict[str, Mounting] = {}
        self.tracks = True
        self.tracked: FrameSet | None = (
            None  # what the newest body is of; None: the newest pictures
        )
        self.slowness: Slowness | None = None
        self.preparing = ""
        self.skeleton = standard_skeleton(1.75)
        self._state_dir = state_dir
        self._died: list[BaseException] = []

    def show(
        self, camera: str, seq: int, t_ns: int | None = None, encoded: bytes | None = None
    ) -> Frame:
        """Hand in a picture: grey, as bright as `seq`, 640x480."""
        pixels = np.full((480, 640, 3), seq % 256, dtype=np.uint8)
        picture = pixels if encoded is None else JpegPicture(encoded, pixels)
        frame = Frame(camera, seq, monotonic_ns() if t_ns is None else t_ns, picture)
        assert self.hub is not None
        self.hub.put(frame)
        return frame

    def known(self) -> RecordingMetadata:
        return RecordingMetadata(self.rig, 1.75)

    def setup(self) -> Wizard:
        if self.why_not:
            raise UnavailableError(self.why_not, "cam0", "plug it in")
        if self.wizard is None:
            assert self.hub is not None
            steps = {StepName.CAMERAS: ListeningStep}
            wizard = Wizard(
                self.hub, steps, dict, self._state_dir, self._state_dir, self._died.append
            )
            wizard.start()
            self.begun += 1
            self.wizard = wizard
        return self.wizard

    def body(self) -> BodySample | None:
        if not self.tracks:
            return None
        now_ns = monotonic_ns()
        pose = canned_pose(self.skeleton, CannedMotion(), now_ns)
        joints_m = joint_positions(self.skeleton, pose)
        confidence = np.ones(len(joints_m))
        confidence[INDEX["rightHand"]] = 0.1
        confidence[BELOW_THE_HIPS] = 0.0
        uncertainty_m = np.full(len(joints_m), 0.02)
        uncertainty_m[INDEX["rightHand"]] = 0.12
        uncertainty_m[BELOW_THE_HIPS] = np.inf
        state = BodyState(
            now_ns,
            Tracking.LIVE,
            "canned",
            pose,
            joints_m,
            confidence,
            uncertainty_m=uncertainty_m,
        )
        return BodySample(Track(state, mean_shape(1.75)), self.skeleton, self._frames(now_ns))

    def _frames(self, now_ns: int) -> FrameSet:
        if self.tracked is not None or self.hub is None:
            return self.tracked or FrameSet(now_ns, {})
        newest = {name: self.hub.newest(name) for name in self.hub.names}
        return FrameSet(now_ns, {name: one for name, one in newest.items() if one is not None})

    @property
    def recordings(self) -> Recordings | None:
        return self.made

    def recenter(self) -> None:
        if not self.tracks:
            raise UnavailableError(
                "no person in view whose heading could become forward",
                "the daemon",
                "stand in view",
            )
        self.recentered += 1

    def _recorder(self, path: Path) -> BodyRecorder:
        return BodyRecorder(self.bodies, path, self.known(), "pc")

    def snapshot(self) -> Snapshot | None:
        if not self.tracks:
            return None
        assert self.hub is not None
        t_s = monotonic_ns() / 1e9
        ms = Percentiles(31.0 + 4 * np.sin(t_s / 5), 48.0 + 9 * np.sin(t_s / 3))
        never = Percentiles(float("nan"), float("nan"))
        latencies = LatencyHistogram()
        for latency_ms in (20.0, 30.0, 2000.0):
            latencies.add(latency_ms)
        metrics = Metrics(
            *(29.7 + np.sin(t_s), 100, 101, 1, ms, ms, never, Tracking.LIVE, "canned", {}),
            latency_counts=latencies.counts(),
            slowness=self.slowness,
            effort=Effort.FULL if self.slowness is None else Effort.LEAST,
        )
        lost = "/dev/video2: gone -- plug it in again"
        status = {
            name: CaptureStatus(
                name,
                CaptureState.LOST if i == 1 else CaptureState.LIVE,
                *(lost if i == 1 else "", 100, 0, 0, 29.9, None),
            )
            for i, name in enumerate(self.hub.names)
        }
        return Snapshot(
            metrics,
            status,
            {"osc": SinkStatus(99, 1, 1, "receiver on 127.0.0.1:39541")},
            self.mountings,
            self.preparing,
        )

    def stop(self) -> None:
        """End the setup, if one was begun."""
        if self.wizard is not None:
            assert self.wizard.stop()
        assert self._died == []
