"""What a user may set of the published method."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class ColourPaperSection:
    """Which of the paper's methods.

    baseline: without pose prior and adaptive white balance, as the paper's own yardstick
    tolerant: with colours that spread as cloth in real folds and lamps does, and thresholds to match
    """

    baseline: bool = False
    tolerant: bool = False
