"""A simulated person as she truly moves, without cameras, tracker or daemon: for tests, and to try the game."""

from goalkeeper.core.limbs import LimbPose, pose_of_joints
from goalkeeper.streams.sighting import Sighting, StreamState
from mocapd.body.bones import NAMES
from mocapd.sim.scenario import Scenario
from mocapd.sim.world import World


class PersonStream:
    """Sightings at a constant rate, each so long after it was; a loop is worked out once."""

    def __init__(self, scenario: Scenario, rate_hz: float = 60.0, latency_s: float = 0.0) -> None:
        self._world = World(scenario)
        self._rate_hz, self._latency_s = rate_hz, latency_s
        self._number = 0
        self._loop = round(scenario.loop_s * rate_hz)
        self._poses: dict[int, LimbPose | None] = {}

    def poll(self, now_s: float) -> list[Sighting]:
        """What is new at now_s."""
        out: list[Sighting] = []
        while (t_s := self._number / self._rate_hz) + self._latency_s <= now_s:
            out.append(Sighting(t_s, self._pose(self._number % self._loop)))
            self._number += 1
        return out

    def _pose(self, number: int) -> LimbPose | None:
        if number not in self._poses:
            joints_m = self._world.at(number / self._rate_hz).joints_m.tolist()
            self._poses[number] = pose_of_joints(dict(zip(NAMES, joints_m, strict=True)))
        return self._poses[number]

    def state(self) -> StreamState:
        """Never ends."""
        return StreamState()

    def close(self) -> None:
        """Nothing to let go of."""
