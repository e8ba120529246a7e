"""How much of each body part is on the foreground: counts of samples on its axis."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mocapd.types import Bytes, Floats, Ints
from mocapd.vision.foreground_kernels import BACKGROUND, SHADOW, UNKNOWN


@dataclass(frozen=True, slots=True, eq=False)
class PartSamples:
    """Counts (C,) of each part's samples in the pictures: on the background, its shadows included; where the background is
    unknown; of all."""

    on_background: Ints
    on_unknown: Ints
    every: Ints

    @classmethod
    def none(cls, n_parts: int) -> "PartSamples":
        """Without any sample."""
        return cls(*(np.zeros(n_parts, np.int64) for _ in range(3)))

    def __add__(self, other: "PartSamples") -> "PartSamples":
        """The samples of both."""
        return PartSamples(
            self.on_background + other.on_background,
            self.on_unknown + other.on_unknown,
            self.every + other.every,
        )

    def confirmed_shares(self) -> Floats:
        """Share (C,) of each part on the foreground, 0..1; an unknown sample counts half, and so does a part that no picture
        shows."""
        against = self.on_background + 0.5 * self.on_unknown
        return np.where(self.every > 0, 1.0 - against / np.maximum(self.every, 1), 0.5)

    def body_share(self) -> float:
        """Share of the body that is not on the background, 0..1: the mean over the parts that a picture shows, 1 without any.

        An unknown sample says nothing against the body: after a takeover the room behind it is unknown, and the few
        samples beside it must not decide.
        """
        shown = self.every > 0
        if not shown.any():
            return 1.0
        return float(1.0 - (self.on_background[shown] / self.every[shown]).mean())


def samples_of(labels: Bytes, inside: NDArray[np.bool_], along: int) -> PartSamples:
    """Count labels (C * along,) as of `stands_before`, of `along` samples a part; inside: those in the picture."""
    background = inside & ((labels == BACKGROUND) | (labels == SHADOW))
    counts = (
        np.count_nonzero(which.reshape(-1, along), axis=1)
        for which in (background, inside & (labels == UNKNOWN), inside)
    )
    return PartSamples(*counts)
