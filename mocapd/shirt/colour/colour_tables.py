"""The look-up table of one camera: a colour model under that camera's white balance."""

import numpy as np

from mocapd.shirt.colour.colour_model import ColourModel, fold
from mocapd.shirt.colour.lut_kernels import TABLE_SIZE, build_tables
from mocapd.types import Bytes, Floats


def colour_table(model: ColourModel, W: Floats, threshold: float) -> Bytes:
    """Ids (32768,) for `classify_by_table` under white balance W (3,3); threshold: T of step 1 [standard deviations]."""
    whitening, ids = fold(model, W), np.empty(TABLE_SIZE, dtype=np.uint8)
    build_tables(whitening.upper, whitening.offset, threshold, ids)
    return ids
