"""Groups the pictures of all cameras by instant: those of one position of the board."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from mocapd.calibrate.board.board_detection import BoardView
from mocapd.types import Floats, Ints

IN_STEP = 0.1  # instants; pictures with less delay count as simultaneous without a trajectory of the board
_BURST = 5  # successive positions, which give the motion at the middle one


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
        return _instant_of(self.source, index)


def gather(
    views: Mapping[str, Mapping[int, BoardView]],
    times_s: Mapping[str, Mapping[int, float]],
    period_s: float,
    start_s: float,
    most: int,
    in_step: bool,
    kept: int | None = None,
) -> Instants:
    """Instants every `period_s` from `start_s` on, each with the nearest picture of each camera. More than `most`
    instants are thinned: evenly for cameras in_step, which gives the board at the most places; otherwise to bursts, which
    allow estimating motion. `kept`: the index of a picture whose instant stays."""
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
    chosen = set(_thin(every, most, in_step and late < IN_STEP).tolist())
    if kept is not None and (instant_kept := _instant_of(source, kept)) is not None:
        chosen.add(instant_kept)
    return Instants(
        {
            name: {i: views[name][k] for i, k in sorted(own.items()) if i in chosen}
            for name, own in source.items()
        },
        {name: {i: lag for i, lag in own.items() if i in chosen} for name, own in lags.items()},
        {name: {i: k for i, k in own.items() if i in chosen} for name, own in source.items()},
        period_s,
    )


def _instant_of(source: Mapping[str, Mapping[int, int]], index: int) -> int | None:
    for own in source.values():
        for instant, picture in own.items():
            if picture == index:
                return instant
    return None


def _thin(instants: Ints, most: int, in_step: bool) -> Ints:
    """All instants, or so many evenly over the recording; not in_step in bursts of a few successive ones."""
    if len(instants) <= most:
        return instants
    if in_step:
        return instants[:: -(-len(instants) // most)]
    bursts = max(1, most // _BURST)
    starts: Floats = np.linspace(0, len(instants) - _BURST, bursts)
    rows = np.round(starts).astype(np.int64)[:, None] + np.arange(_BURST)
    return np.asarray(np.unique(instants[rows.ravel()]), dtype=np.int64)
