"""The look-up table of one camera: a colour model under that camera's white balance."""

from dataclasses import dataclass, field

import numpy as np

from mocapd.errors import ConfigError
from mocapd.shirt.colour.colour_model import ColourModel, fold
from mocapd.shirt.colour.lut_kernels import TABLE_SIZE, build_tables
from mocapd.types import Bytes, Floats


def _ids() -> Bytes:
    return np.zeros(TABLE_SIZE, dtype=np.uint8)


@dataclass(frozen=True, slots=True, eq=False)
class ColourTables:
    """Arguments of the kernels in `lut_kernels`; allocated once, refilled for each new W.

    ids (32768,) uint8: see `build_tables`. Not for two threads at once.
    """

    ids: Bytes = field(default_factory=_ids)

    def refill(self, model: ColourModel, W: Floats, threshold: float) -> None:
        """The table for white balance W (3,3) and T of step 1 [standard deviations]."""
        if not threshold > 0.0:
            raise ConfigError(
                f"threshold {threshold}", "colour classification", "choose one above 0"
            )
        whitening = fold(model, W)
        build_tables(whitening.upper, whitening.offset, threshold, self.ids)
