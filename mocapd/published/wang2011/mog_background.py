"""Background subtraction: an adaptive mixture of Gaussians per pixel [SG99], as a hint."""

from dataclasses import dataclass

import cv2
import numpy as np

from mocapd.types import Bytes


@dataclass(frozen=True, slots=True)
class MixtureParams:
    """`shift`: the mask is 2^shift times smaller than the frame, each way.

    `history`: frames the mixture remembers; `deviation2`: squared Mahalanobis distance beyond
    which a pixel is foreground; `grow`: dilation [mask pixels], so that a hint does not cut off
    thin arms.
    """

    shift: int = 2
    history: int = 300
    deviation2: float = 16.0
    grow: int = 1


def mask_size(size_px: tuple[int, ...], shift: int) -> tuple[int, int]:
    """Height and width of the mask that covers a frame of this height and width."""
    height, width = size_px
    return -(-height >> shift), -(-width >> shift)


class BackgroundSubtractor:
    """The background of one camera. It learns from every frame it is given; one thread."""

    def __init__(self, params: MixtureParams) -> None:
        self.params = params
        self.reset()

    def reset(self) -> None:
        """Forget the background."""
        self._mixture = cv2.createBackgroundSubtractorMOG2(
            history=self.params.history,
            varThreshold=self.params.deviation2,
            detectShadows=False,
        )

    def apply(self, pixels: Bytes) -> Bytes:
        """The mask uint8 of `pixels` (H,W,3): 0 background, 255 foreground; of the size `mask_size`.

        The first frame after a reset has no foreground.
        """
        step = 1 << self.params.shift
        small = np.ascontiguousarray(pixels[step // 2 :: step, step // 2 :: step])
        mask = self._mixture.apply(small)
        if self.params.grow > 0:
            size = 2 * self.params.grow + 1
            mask = cv2.dilate(mask, np.ones((size, size), dtype=np.uint8))
        # blocks that the frame's edge cuts before their middle are like those beside them
        h, w = mask_size(pixels.shape[:2], self.params.shift)
        below, right = h - mask.shape[0], w - mask.shape[1]
        mask = cv2.copyMakeBorder(mask, 0, below, 0, right, cv2.BORDER_REPLICATE)
        return np.asarray(mask, dtype=np.uint8)
