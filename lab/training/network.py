"""The network of heatmaps.

Five halvings of the picture, three doublings with what was there before (feature pyramids, Lin et al. 2017). For each of J
joints a map of log odds, and, weighted by that map, its depth beside the hips and the logarithm of the scale of a Laplace
distribution about it. Toes have a layer of their own, and the person's mask a fourth doubling and one by shuffled pixels
(Shi et al. 2016). While training, the deepest layer also tells which way the trunk faces: without that left and right were
not told apart after 100 000 pictures.
"""

from collections.abc import Sequence

import torch
from torch import Tensor, nn
from torch.nn import functional as F  # noqa: N812 (its usual name)

JOINTS, TOES = (
    17,
    2,
)  # in the order of mocapd.vision.heatmaps.joint_network.JOINTS, of which the last are toes
INPUT_PX, CELLS = 96, 24
WIDTHS, UP, RESIDUALS = (24, 40, 80, 80, 112), (64, 48, 40), (1, 2, 1)
_TOES_WIDTH, _MASK_WIDTH = 24, 16


def convolved(i: int, o: int, stride: int = 1, size: int = 3) -> nn.Sequential:
    """A convolution, rectified."""
    return nn.Sequential(nn.Conv2d(i, o, size, stride, size // 2), nn.ReLU(True))


class Residual(nn.Module):
    """Two convolutions added to what goes in."""

    def __init__(self, width: int) -> None:
        super().__init__()
        self.a = convolved(width, width)
        self.b = nn.Sequential(nn.Conv2d(width, width, 3, 1, 1))

    def forward(self, x: Tensor) -> Tensor:
        return F.relu(x + self.b(self.a(x)), inplace=True)


class Network(nn.Module):
    """(B,4,96,96) to maps (B,3 J,24,24) and log odds (B,1,96,96) that a pixel is the person."""

    def __init__(
        self,
        widths: Sequence[int] = WIDTHS,
        up: Sequence[int] = UP,
        residuals: Sequence[int] = RESIDUALS,
    ) -> None:
        """widths: of the picture halved once to five times; up: of it doubled again; residuals: after the third to the
        fifth halving."""
        super().__init__()
        self.sizes, c = (widths, up, residuals), widths
        self.d1 = convolved(4, c[0], 2)
        self.d2 = nn.Sequential(convolved(c[0], c[1], 2), convolved(c[1], c[1]))
        self.d3, self.d4, self.d5 = (
            nn.Sequential(convolved(c[k + 1], c[k + 2], 2), *(Residual(c[k + 2]) for _ in range(n)))
            for k, n in enumerate(residuals)
        )
        self.l5, self.l4 = convolved(c[4], up[0], 1, 1), convolved(c[3], up[0], 1, 1)
        self.u4 = convolved(up[0], up[0])
        self.m4, self.l3 = convolved(up[0], up[1], 1, 1), convolved(c[2], up[1], 1, 1)
        self.u3 = Residual(up[1])
        self.m3, self.l2 = convolved(up[1], up[2], 1, 1), convolved(c[1], up[2], 1, 1)
        self.u2 = convolved(up[2], up[2])
        self.head = nn.Conv2d(up[2], 3 * (JOINTS - TOES), 1)
        self.yaw = nn.Conv2d(c[4], 2, 1)
        self.toes = nn.Sequential(
            convolved(up[2] + c[1], _TOES_WIDTH), nn.Conv2d(_TOES_WIDTH, 3 * TOES, 1)
        )
        self.m2, self.l1 = convolved(up[2], _MASK_WIDTH, 1, 1), convolved(c[0], _MASK_WIDTH, 1, 1)
        self.u1, self.mask = Residual(_MASK_WIDTH), nn.Conv2d(_MASK_WIDTH, 4, 1)

    def forward(self, x: Tensor) -> tuple[Tensor, Tensor]:
        maps, odds, _ = self.told(x)
        return maps, odds

    def told(self, x: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        """Maps, log odds, and (B,2) which way the trunk faces, for training alone."""
        edges = self.d1(x)
        a = self.d2(edges)
        b = self.d3(a)
        c = self.d4(b)
        d = self.d5(c)
        facing = self.yaw(d.mean((2, 3), keepdim=True))[:, :, 0, 0]
        y = self.u4(self.l4(c) + _doubled(self.l5(d)))
        y = self.u3(self.l3(b) + _doubled(self.m4(y)))
        y = self.u2(self.l2(a) + _doubled(self.m3(y)))
        joints = self.head(y).reshape(-1, 3, JOINTS - TOES, CELLS, CELLS)
        toes = self.toes(torch.cat([y, a], 1)).reshape(-1, 3, TOES, CELLS, CELLS)
        maps = torch.cat([joints, toes], 2).reshape(-1, 3 * JOINTS, CELLS, CELLS)
        z = self.u1(self.l1(edges) + _doubled(self.m2(y)))
        return maps, F.pixel_shuffle(self.mask(z), 2), facing


def _doubled(x: Tensor) -> Tensor:
    return F.interpolate(x, scale_factor=2, mode="nearest")
