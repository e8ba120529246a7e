"""Measures how much of the room and of the directions the wearer's walk covered, and advises on the rest."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from mocapd.calibrate.self_calibration.joint_solver import SelfCalibrationParams
from mocapd.calibrate.self_calibration.patch_tracks import PatchObservation
from mocapd.clock import seconds
from mocapd.geometry import rotations

_LONGEST_GAP_S = 0.2  # between sets of continuous visibility
_SECTOR_RAD = np.radians(30.0)
_CELL_M = 0.3


@dataclass(frozen=True, slots=True)
class WalkParams:
    """Enough are `good_s` in view of two cameras at once, with so many facings of 30 degrees and places of 0.3 m among
    them; or `longest_good_s` of anything. patience_s: timeout [s]."""

    good_s: float = 20.0
    facings: int = 4
    places: int = 4
    longest_good_s: float = 30.0
    patience_s: float = 75.0
    extrinsics: SelfCalibrationParams = field(default_factory=SelfCalibrationParams)


class Coverage:
    """Coverage of room and directions by the walk, observation by observation."""

    def __init__(self, names: Sequence[str], params: WalkParams) -> None:
        self._names, self._p = tuple(names), params
        self.good_s = 0.0
        self.visible_s = dict.fromkeys(names, 0.0)  # by camera, alone or not
        self._facings: set[int] = set()
        self._places: set[tuple[int, int]] = set()
        self._last_ns: int | None = None

    def add(self, observation: PatchObservation, t_ns: int) -> None:
        dt_s = 0.0 if self._last_ns is None else seconds(t_ns - self._last_ns)
        self._last_ns = t_ns
        dt_s = min(dt_s, _LONGEST_GAP_S)
        for name in observation:
            self.visible_s[name] += dt_s
        if len(observation) < 2:
            return
        self.good_s += dt_s
        first = next(name for name in self._names if name in observation)
        if first != self._names[0]:
            return  # facings and places are comparable in one camera's frame only
        sighting = observation[first]
        facing = rotations.to_matrix(sighting.quats_xyzw[0])[:, 2]
        self._facings.add(int(np.arctan2(facing[0], facing[2]) // _SECTOR_RAD))
        at = sighting.joints_m[0]
        self._places.add((int(at[0] // _CELL_M), int(at[2] // _CELL_M)))

    @property
    def share(self) -> float:
        """Progress towards enough coverage, 0..1."""
        p = self._p
        if self.good_s >= p.longest_good_s:
            return 1.0
        return float(
            np.mean(
                [
                    min(1.0, self.good_s / p.good_s),
                    min(1.0, len(self._facings) / p.facings),
                    min(1.0, len(self._places) / p.places),
                ]
            )
        )

    @property
    def advice(self) -> str:
        """The next instruction for the wearer."""
        p = self._p
        if len(self._facings) < p.facings:
            return "Walk about, move the arms, and turn a little to each side"
        if len(self._places) < p.places:
            return "Good. Step to the sides, forwards and back"
        return "Good. Go on walking and moving the arms, stretched to all sides"
