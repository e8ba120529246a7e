"""The network of heatmaps.

Five halvings of the picture, three doublings with what was there before (feature pyramids, Lin et al. 2017). For each of J
joints a map of log odds, and, weighted by that map, its depth beside the hips and the logarithm of the scale of a Laplace
distribution about it. Toes have a layer of their own, and the person's mask a fourth doubling and one by shuffled pixels
(Shi et al. 2016). While training, the deepest layer also tells which way the trunk faces: without that left and right were
not told apart after 100 000 pictures.
"""

from pathlib import Path

import onnx
import torch
from onnx.numpy_helper import to_array
from torch import Tensor, nn
from torch.nn import functional as F  # noqa: N812 (its usual name)

JOINTS, TOES = (
    17,
    2,
)  # in the order of mocapd.vision.heatmaps.joint_network.JOINTS, of which the last are toes
INPUT_PX, CELLS = 96, 24
WIDTHS, UP = (16, 24, 48, 80, 112), (48, 40, 32)
_TOES_WIDTH, _MASK_WIDTH = 24, 16


def convolved(i: int, o: int, stride: int = 1, size: int = 3) -> nn.Sequential:
    """A convolution, normalised and rectified."""
    return nn.Sequential(
        nn.Conv2d(i, o, size, stride, size // 2, bias=False), nn.BatchNorm2d(o), nn.ReLU(True)
    )


class Residual(nn.Module):
    """Two convolutions added to what goes in."""

    def __init__(self, width: int) -> None:
        super().__init__()
        self.a = convolved(width, width)
        self.b = nn.Sequential(nn.Conv2d(width, width, 3, 1, 1, bias=False), nn.BatchNorm2d(width))

    def forward(self, x: Tensor) -> Tensor:
        return F.relu(x + self.b(self.a(x)), inplace=True)


class Network(nn.Module):
    """(B,4,96,96) to maps (B,3 J,24,24) and log odds (B,1,96,96) that a pixel is the person; `facing` (B,2) is of the last
    batch."""

    def __init__(self) -> None:
        super().__init__()
        c, up = WIDTHS, UP
        self.d1 = convolved(4, c[0], 2)
        self.d2 = nn.Sequential(convolved(c[0], c[1], 2), convolved(c[1], c[1]))
        self.d3 = nn.Sequential(convolved(c[1], c[2], 2), Residual(c[2]))
        self.d4 = nn.Sequential(convolved(c[2], c[3], 2), Residual(c[3]), Residual(c[3]))
        self.d5 = nn.Sequential(convolved(c[3], c[4], 2), Residual(c[4]))
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
        self.facing = torch.zeros(0, 2)

    def forward(self, x: Tensor) -> tuple[Tensor, Tensor]:
        edges = self.d1(x)
        a = self.d2(edges)
        b = self.d3(a)
        c = self.d4(b)
        d = self.d5(c)
        self.facing = self.yaw(d.mean((2, 3), keepdim=True))[:, :, 0, 0]
        y = self.u4(self.l4(c) + _doubled(self.l5(d)))
        y = self.u3(self.l3(b) + _doubled(self.m4(y)))
        y = self.u2(self.l2(a) + _doubled(self.m3(y)))
        joints = self.head(y).reshape(-1, 3, JOINTS - TOES, CELLS, CELLS)
        toes = self.toes(torch.cat([y, a], 1)).reshape(-1, 3, TOES, CELLS, CELLS)
        maps = torch.cat([joints, toes], 2).reshape(-1, 3 * JOINTS, CELLS, CELLS)
        z = self.u1(self.l1(edges) + _doubled(self.m2(y)))
        return maps, F.pixel_shuffle(self.mask(z), 2)

    def hold_joints(self) -> None:
        """Train toes and mask alone: the joints stay what they are, to the bit."""
        self.requires_grad_(requires_grad=False)
        self.eval()
        for one in (self.toes, self.m2, self.l1, self.u1, self.mask):
            one.requires_grad_(requires_grad=True)
            one.train()


def _doubled(x: Tensor) -> Tensor:
    return F.interpolate(x, scale_factor=2, mode="nearest")


def take_over(network: Network, exported: Path, x: Tensor) -> None:
    """Begin with the weights of an exported network, in which each normalisation went into the convolution before it: it is
    set so that of this batch it gives back what it takes, and adds what that convolution had. What comes after the last of
    its convolutions, as toes and mask of an older one, begins anew."""
    graph = onnx.load(exported).graph
    known = {one.name: torch.from_numpy(to_array(one).copy()) for one in graph.initializer}
    convolutions = [node for node in graph.node if node.op_type == "Conv"]
    weights = iter([[known[name] for name in node.input[1:3]] for node in convolutions])
    added: Tensor | None = None

    @torch.no_grad()
    def set_convolution(module: nn.Conv2d, _: object) -> None:
        nonlocal added
        if module is not network.yaw:  # tells nothing but while training, so it is not exported
            weight, added = next(weights, (None, None))
            if weight is None or added is None:
                return
            module.weight.copy_(weight)
            if module.bias is not None:
                module.bias.copy_(added)

    @torch.no_grad()
    def set_normalisation(module: nn.BatchNorm2d, taken: tuple[Tensor]) -> None:
        if added is None:
            return
        variance, mean = torch.var_mean(taken[0], (0, 2, 3), correction=0)
        module.running_mean.copy_(mean)
        module.running_var.copy_(variance)
        module.weight.copy_((variance + module.eps).sqrt())
        module.bias.copy_(mean + added)

    hooks = [
        module.register_forward_pre_hook(
            set_convolution if isinstance(module, nn.Conv2d) else set_normalisation
        )
        for module in network.modules()
        if isinstance(module, (nn.Conv2d, nn.BatchNorm2d))
    ]
    with torch.no_grad():
        network(x)
    for hook in hooks:
        hook.remove()
