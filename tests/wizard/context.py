"""What a step is given to work with in the tests: a hub to feed, jobs that run when told to."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from mocapd.capture.camera_thread.capture_status import CaptureState, CaptureStatus
from mocapd.errors import MocapdError
from mocapd.pipeline.frame_hub import FrameHub
from mocapd.types import Bytes, Frame
from mocapd.wizard.commands import read_command
from mocapd.wizard.context import Step
from mocapd.wizard.draft import Draft
from mocapd.wizard.step import Scene, T, Tell


def do(step: Step, verb: str, args: Mapping[str, object] | None = None) -> None:
    """What the page does: a command is read, and taken. Raises MocapdError when it is refused."""
    step.command(read_command(step.verbs, verb, args or {}, step.name))


TICK_NS = 50_000_000
BEGIN_NS = 1_000_000_000


class FakeContext:
    """A Context without threads. Time is `now_ns`; a job runs in `run_job`, or at once in `drive`."""

    def __init__(self, folder: Path, draft: Draft) -> None:
        self.hub = FrameHub([camera.id for camera in draft.cameras])
        self.draft = draft
        self.state_dir, self.cache_dir = folder / "state", folder / "cache"
        self.state_dir.mkdir(parents=True, exist_ok=True)
        self.cache_dir.mkdir(parents=True, exist_ok=True)
        self.scenes: list[Scene] = []
        self.lost: dict[str, str] = {}  # the reason by camera, of those that have stopped
        self.rates_hz: dict[str, float] = {}  # of cameras that do not deliver 30
        self.times_saved = 0
        self.now_ns = BEGIN_NS
        self.told: list[tuple[str, float]] = []
        self._seq = 0
        self._job: Callable[[Tell], Any] | None = None
        self._job_done: Callable[[Any], None] | None = None

    # -- Context ---------------------------------------------------------------------------------

    def statuses(self) -> Mapping[str, CaptureStatus]:
        """All live but those in `lost`."""
        return {
            name: CaptureStatus(
                name,
                CaptureState.LOST if name in self.lost else CaptureState.LIVE,
                self.lost.get(name, ""),
                self._seq,
                0,
                0,
                self.rates_hz.get(name, 30.0),
                self.now_ns,
            )
            for name in self.hub.names
        }

    def scene(self, scene: Scene) -> None:
        """Remembered in `scenes`."""
        self.scenes.append(scene)

    def start_job(self, job: Callable[[Tell], T], done: Callable[[T], None]) -> None:
        """Kept until `run_job`."""
        assert self._job is None, "one job at a time"
        self._job, self._job_done = job, done

    def on_saved(self) -> None:
        """Counted."""
        self.times_saved += 1

    @property
    def job(self) -> tuple[str, float] | None:
        """As in the wizard."""
        if self._job is None:
            return None
        return self.told[-1] if self.told else ("", 0.0)

    # -- for tests -------------------------------------------------------------------------------

    def run_job(self, step: Step) -> bool:
        """Do the job that waits, here; whether there was one."""
        if self._job is None or self._job_done is None:
            return False
        job, done = self._job, self._job_done
        self.told = []
        try:
            result = job(lambda what, share: self.told.append((what, share)))
        except MocapdError as error:
            self._job = self._job_done = None
            step.job_failed(error)
        else:
            self._job = self._job_done = None
            done(result)
        return True

    def put(self, camera: str, pixels: Bytes, late_ns: int = 0) -> Frame:
        """A picture taken now, or `late_ns` [ns] before."""
        self._seq += 1
        frame = Frame(camera, self._seq, self.now_ns - late_ns, pixels)
        self.hub.put(frame)
        return frame

    def drive(
        self, step: Step, pictures: Mapping[str, Bytes], seconds: float = TICK_NS / 1e9
    ) -> None:
        """So many seconds of ticks, in each of which these pictures come; jobs run at once."""
        for _ in range(max(1, round(seconds * 1e9 / TICK_NS))):
            for camera, pixels in pictures.items():
                self.put(camera, pixels)
            step.tick(self.now_ns)
            self.run_job(step)
            step.view()
            self.now_ns += TICK_NS
