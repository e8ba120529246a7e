"""Simulated webcams that film a stage, on which the scenes of a first setup are played on request."""

import threading
from collections.abc import Mapping

from mocapd.capture.simulated.sim import SimCamera
from mocapd.clock import monotonic_ns
from mocapd.sim.clips import Clip
from mocapd.sim.scenario import Scenario
from mocapd.sim.setup_scenes import SetupScene


class Stage:
    """The scene that all cameras of a setup film. Thread-safe.

    The stage is empty at first.
    """

    def __init__(
        self, scenario: Scenario, clips: Mapping[SetupScene, Clip], epoch_ns: int | None = None
    ) -> None:
        """clips: of every scene; epoch_ns: when frame 0 is exposed, now when absent."""
        self.scenario = scenario
        self.epoch_ns = monotonic_ns() if epoch_ns is None else epoch_ns
        self._clips = clips
        self._lock = threading.Lock()  # guards what follows
        self._scene = self._before = SetupScene.EMPTY
        self._start = self._start_before = 0

    def play(self, scene: str) -> int:
        """Play a scene from its beginning, with the next frame that is exposed; its number.

        The scene that is being played goes on. Raises ValueError when there is no such scene.
        """
        wanted = SetupScene(scene)
        elapsed_ns = monotonic_ns() - self.epoch_ns
        next_frame = max(int(elapsed_ns * self.scenario.fps_hz // 1_000_000_000) + 1, 0)
        with self._lock:
            if wanted is not self._scene:
                if next_frame > self._start:  # else no camera has shown the previous scene
                    self._before, self._start_before = self._scene, self._start
                self._scene, self._start = wanted, next_frame
            return self._start

    def jpeg(self, camera: str, n: int) -> bytes:
        """The camera's picture of frame n, a recent frame or the next one."""
        with self._lock:
            scene, start = self._scene, self._start
            if n < start:
                scene, start = self._before, self._start_before
        return self._clips[scene].jpeg(camera, n - start)


class SceneSource(SimCamera):
    """One camera before a stage. Raises ConfigError for one that the stage's scenario has not."""

    def __init__(self, stage: Stage, camera: str) -> None:
        super().__init__(stage.scenario, camera, lambda n: stage.jpeg(camera, n), stage.epoch_ns)
