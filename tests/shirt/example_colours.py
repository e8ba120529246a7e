"""Ten colours of a shirt, and the white balance of a camera, as examples."""

import numpy as np

from mocapd.shirt.colour.colour_model import ColourModel
from mocapd.types import Floats

NAMES = ("red", "orange", "yellow", "lime", "green", "cyan", "blue", "violet", "magenta", "pink")
MEANS = np.array(
    [
        [0.73, 0.16, 0.19],
        [0.88, 0.45, 0.15],
        [0.85, 0.74, 0.18],
        [0.50, 0.71, 0.21],
        [0.14, 0.46, 0.24],
        [0.16, 0.61, 0.67],
        [0.17, 0.29, 0.66],
        [0.37, 0.23, 0.50],
        [0.72, 0.19, 0.49],
        [0.83, 0.56, 0.63],
    ]
)


def example_model(seed: int = 0) -> ColourModel:
    """Ten well separated colours with skewed covariances."""
    spread = np.random.default_rng(seed).normal(0.0, 0.04, (10, 3, 3))
    covariance = spread @ spread.transpose(0, 2, 1) + 0.03**2 * np.eye(3)
    return ColourModel(NAMES, MEANS, covariance, "test")


def example_white_balance() -> Floats:
    return np.array([[1.10, 0.12, -0.03], [0.05, 0.95, 0.10], [0.00, 0.15, 1.30]])
