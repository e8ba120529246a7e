"""Pictures of all cameras gathered by instant: which belong to one position of the board."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from mocapd.calibrate.board.board_detection import BoardView
from mocapd.types import Floats, Ints

IN_STEP = (
    0.1  # instants, up to which pictures are taken for simultaneous without following the board
)
_BURST = 5  # positions next to each other, from which the motion of the one in the middle is known


@dataclass(frozen=True, slots=True, eq=False)
class Instants:
    """views[camera][instant], lags[camera][instant]: from the instant to that picture [instants], and
    source[camera][instant]: the picture's index. period_s between instants."""

    views: Mapping[str, Mapping[int, BoardView]]
    lags: Mapping[str, Mapping[int, float]]
    source: Mapping[str, Mapping[int, int]]
    period_s: float

    def of_picture(self, index: int) -> int | None:
        """The instant of a picture with that index, by the first camera that has it."""
        for own in self.source.values():
            for instant, picture in own.items():
                if picture == index:
                    return instant
        return None


def gather(
    views: Mapping[str, Mapping[int, BoardView]],
    times_s: Mapping[str, Mapping[int, float]],
    period_s: float,
    start_s: float,
    most: int,
    in_step: bool,
) -> Instants:
    """Instants every `period_s` from `start_s` on, each picture with the nearest; of several pictures of one camera
    the nearest. More than `most` instants are thinned: evenly, which shows the board at the most places, where the
    cameras are in_step; else to bursts, so that motion can be followed."""
    lags: dict[str, dict[int, float]] = {name: {} for name in views}
    source: dict[str, dict[int, int]] = {name: {} for name in views}
    for name, own in views.items():
        for index in own:
            if index not in times_s[name]:
                continue
            at = (times_s[name][index] - start_s) / period_s
            instant = round(at)
            lag = at - instant
            if abs(lag) < abs(lags[name].get(instant, np.inf)):
                lags[name][instant], source[name][instant] = lag, index
    every = np.array(sorted({instant for own in lags.values() for instant in own}), dtype=np.int64)
    late = max((abs(lag) for own in lags.values() for lag in own.values()), default=0.0)
    kept = set(_thinned(every, most, in_step and late < IN_STEP).tolist())
    return Instants(
        {
            name: {i: views[name][k] for i, k in sorted(own.items()) if i in kept}
            for name, own in source.items()
        },
        {name: {i: lag for i, lag in own.items() if i in kept} for name, own in lags.items()},
        {name: {i: k for i, k in own.items() if i in kept} for name, own in source.items()},
        period_s,
    )


def _thinned(instants: Ints, most: int, in_step: bool) -> Ints:
    """All, or so many evenly over the recording, not in_step in bursts of a few next to each other."""
    if len(instants) <= most:
        return instants
    if in_step:
        return instants[:: -(-len(instants) // most)]
    bursts = max(1, most // _BURST)
    starts: Floats = np.linspace(0, len(instants) - _BURST, bursts)
    rows = np.round(starts).astype(np.int64)[:, None] + np.arange(_BURST)
    return np.asarray(np.unique(instants[rows.ravel()]), dtype=np.int64)
