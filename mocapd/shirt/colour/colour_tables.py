"""The look-up tables of one camera: a colour model seen through that camera's white balance."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from mocapd.errors import ConfigError
from mocapd.shirt.colour.colour_model import ColourModel
from mocapd.shirt.colour.lut_kernels import MAX_REACH, TABLE_SIZE, build_tables
from mocapd.shirt.colour.whitening import fold
from mocapd.types import Bytes, Floats


def _ids() -> Bytes:
    return np.zeros(TABLE_SIZE, dtype=np.uint8)


def _colours() -> NDArray[np.uint16]:
    return np.zeros(TABLE_SIZE, dtype=np.uint16)


def _distances() -> Bytes:
    return np.zeros((TABLE_SIZE, 10), dtype=np.uint8)


@dataclass(frozen=True, slots=True, eq=False)
class ColourTables:
    """Arguments of the kernels in `lut_kernels`; allocated once, refilled for each new W.

    ids (32768,) uint8, colours (32768,) uint16, distances (32768,10) uint8: see `build_tables`.
    Not for two threads at once.
    """

    ids: Bytes = field(default_factory=_ids)
    colours: NDArray[np.uint16] = field(default_factory=_colours)
    distances: Bytes = field(default_factory=_distances)

    def refill(self, model: ColourModel, W: Floats, threshold: float, reach: float) -> None:
        """Tables for white balance W (3,3), thresholds in [standard deviations].

        `threshold` is T of step 1; `reach` that of step 3, from `threshold` to MAX_REACH.
        """
        if not 0.0 < threshold <= reach <= MAX_REACH:
            raise ConfigError(
                f"thresholds {threshold} (colour alone) and {reach} (with the pose as prior)",
                "colour classification",
                f"choose 0 < the first <= the second <= {MAX_REACH:.1f}",
            )
        whitening = fold(model, W)
        build_tables(
            whitening.upper,
            whitening.offset,
            threshold,
            reach,
            self.ids,
            self.colours,
            self.distances,
        )
