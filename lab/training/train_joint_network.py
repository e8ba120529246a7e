"""Train the network of heatmaps on pictures that lab.training.training_pictures drew; see README.md beside this.

The network: five halvings of the picture, three doublings with what was there before (feature pyramids, Lin et al. 2017).
For each of J joints a map of log odds (cross-entropy with a Gaussian of 0.8 cells), and, weighted by that map, its depth
beside the hips and the scale of a Laplace distribution about it. While training, the deepest layer also tells which way the
trunk faces: without that left and right were not told apart after 100 000 pictures.
"""

import argparse
import math
import sys
import time
from pathlib import Path

import numpy as np
import onnx
import torch
from onnx.numpy_helper import to_array
from torch import Tensor, nn
from torch.nn import functional as F  # noqa: N812 (its usual name)

JOINTS = 15  # in the order of mocapd.vision.heatmaps.joint_network.JOINTS
LEFT_SHOULDER, RIGHT_SHOULDER = 3, 4
MIRROR = [0, 1, 2, 4, 3, 6, 5, 8, 7, 10, 9, 12, 11, 14, 13]
PICTURE_PX, PICTURE_M = 128, 3.0
INPUT_PX, INPUT_M, CELLS = 96, 2.4, 24
BATCH = 64
BLUR_CELLS = 0.8
FACING_THE_CAMERA = 2.5  # so many times as often as others: so people stand before cameras
WIDTHS, UP = (16, 24, 48, 80, 112), (48, 40, 32)


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
    """(B,4,96,96) to maps (B,3 J,24,24); `facing` (B,2) is of the last batch."""

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
        self.head = nn.Conv2d(up[2], 3 * JOINTS, 1)
        self.yaw = nn.Conv2d(c[4], 2, 1)
        self.facing = torch.zeros(0, 2)

    def forward(self, x: Tensor) -> Tensor:
        a = self.d2(self.d1(x))
        b = self.d3(a)
        c = self.d4(b)
        d = self.d5(c)
        self.facing = self.yaw(d.mean((2, 3), keepdim=True))[:, :, 0, 0]
        y = self.u4(self.l4(c) + _doubled(self.l5(d)))
        y = self.u3(self.l3(b) + _doubled(self.m4(y)))
        y = self.u2(self.l2(a) + _doubled(self.m3(y)))
        return self.head(y)


def _doubled(x: Tensor) -> Tensor:
    return F.interpolate(x, scale_factor=2, mode="nearest")


class Pictures:
    """All pictures, and batches of them altered at random."""

    def __init__(self, folder: Path) -> None:
        files = [np.load(path) for path in sorted(folder.glob("*.npz"))]
        n = sum(len(one["farther"]) for one in files)
        self.pictures = torch.empty((n, PICTURE_PX, PICTURE_PX, 6), dtype=torch.uint8)
        self.uv, self.farther = torch.empty((n, JOINTS, 2)), torch.empty((n, JOINTS))
        at = 0
        for one in files:
            k = len(one["farther"])
            self.pictures[at : at + k] = torch.from_numpy(one["pictures"])
            self.uv[at : at + k] = torch.from_numpy(one["uv"])
            self.farther[at : at + k] = torch.from_numpy(one["farther"])
            at += k
        faces = self.uv[:, LEFT_SHOULDER, 0] > self.uv[:, RIGHT_SHOULDER, 0]
        self._chances = torch.where(faces, FACING_THE_CAMERA, 1.0).double().cumsum(0)

    def batch(self) -> tuple[Tensor, Tensor, Tensor]:
        """Inputs (B,4,96,96), places (B,J,2) in cells, depths (B,J)."""
        drawn = torch.rand(BATCH).double() * self._chances[-1]
        which = torch.searchsorted(self._chances, drawn).clamp(max=len(self.uv) - 1)
        x = self.pictures[which].permute(0, 3, 1, 2).float() / 255.0
        x, uv, farther = moved(x, self.uv[which].clone(), self.farther[which].clone())
        return shown(x[:, :3], x[:, 3:]), uv, farther


def moved(x: Tensor, uv: Tensor, farther: Tensor) -> tuple[Tensor, Tensor, Tensor]:
    """Cut out, larger or smaller, turned, aside, and mirrored in half of all cases."""
    n = len(x)
    size = INPUT_M / PICTURE_M * torch.exp(0.08 * torch.randn(n))
    turn, aside = 0.06 * torch.randn(n), 0.075 * torch.randn(n, 2)
    mirrored = torch.rand(n) < 0.5
    c, s, side = torch.cos(turn) * size, torch.sin(turn) * size, torch.where(mirrored, -1.0, 1.0)
    A = torch.zeros(n, 2, 3)
    A[:, 0, 0], A[:, 0, 1], A[:, 1, 0], A[:, 1, 1], A[:, :, 2] = c * side, -s, s * side, c, aside
    grid = F.affine_grid(A, [n, 6, INPUT_PX, INPUT_PX], align_corners=False)
    x = F.grid_sample(x, grid, mode="bilinear", padding_mode="border", align_corners=False)
    at = (uv + 0.5) / PICTURE_PX * 2.0 - 1.0
    at = torch.einsum("bij,bkj->bki", torch.inverse(A[:, :, :2]), at - A[:, None, :, 2])
    uv = (at + 1.0) / 2.0 * CELLS - 0.5
    m = mirrored[:, None]
    return (
        x,
        torch.where(m[..., None], uv[:, MIRROR], uv),
        torch.where(m, farther[:, MIRROR], farther),
    )


def shown(picture: Tensor, room: Tensor) -> Tensor:
    """As another camera would: in other light, noisier, blurred, before a background that is off, behind boxes."""
    n = len(picture)
    room = (
        room * torch.exp(0.03 * torch.randn(n, 3, 1, 1)) * torch.exp(0.04 * torch.randn(n, 1, 1, 1))
    )
    off = ((picture - room).abs().amax(1, keepdim=True) * 4.0).clamp(0.0, 1.0)
    gain = torch.exp(0.25 * torch.randn(n, 1, 1, 1)) * torch.exp(0.1 * torch.randn(n, 3, 1, 1))
    gamma = torch.exp(0.2 * torch.randn(n, 1, 1, 1))
    picture = (picture.clamp(1e-3, 1.0) ** gamma * gain).clamp(0.0, 1.0)
    grey = picture.mean(1, keepdim=True).expand(-1, 3, -1, -1)
    picture = torch.where(torch.rand(n, 1, 1, 1) < 0.12, grey, picture)
    picture = picture + 0.03 * torch.rand(n, 1, 1, 1) * torch.randn_like(picture)
    soft = torch.rand(n) < 0.25
    if soft.any():
        picture[soft] = F.avg_pool2d(picture[soft], 3, 1, 1)
    off = off + 0.06 * torch.rand(n, 1, 1, 1) * torch.randn_like(off)
    for i in torch.nonzero(torch.rand(n) < 0.35)[:, 0].tolist():
        for _ in range(int(torch.randint(1, 4, (1,)))):
            w, h = torch.randint(4, 28, (2,)).tolist()
            x, y = (int(torch.randint(0, INPUT_PX - k, (1,))) for k in (w, h))
            box = (slice(y, y + h), slice(x, x + w))
            if torch.rand(1) < 0.5:
                off[(i, 0, *box)] = torch.rand(1)
                continue
            if torch.rand(1) < 0.5:
                picture[(i, slice(None), *box)] = torch.rand(3, 1, 1)
            off[(i, 0, *box)] = 0.2 * torch.rand(1)
    off = torch.where(torch.rand(n, 1, 1, 1) < 0.1, torch.zeros_like(off), off)
    return torch.cat([picture - 0.5, off.clamp(0.0, 1.0)], 1)


def loss_of(maps: Tensor, uv: Tensor, farther: Tensor) -> tuple[Tensor, Tensor]:
    """The loss of a batch, and how far off each joint is (J,) [cm]."""
    odds, depth, scale = (one.flatten(2) for one in maps.split(JOINTS, 1))
    p = F.softmax(odds, -1)
    cells = torch.arange(CELLS).float()
    inside = ((uv > -0.5) & (uv < CELLS - 0.5)).all(-1).float()
    spread = 2.0 * BLUR_CELLS**2
    near_x, near_y = (torch.exp(-((cells - uv[..., k : k + 1]) ** 2) / spread) for k in (0, 1))
    wanted = (near_y[..., :, None] * near_x[..., None, :]).flatten(2)
    wanted = wanted / wanted.sum(-1, keepdim=True).clamp(1e-9)
    surprise = -(wanted * F.log_softmax(odds, -1)).sum(-1)
    log_scale = (p * scale).sum(-1).clamp(-4.0, 1.0)
    deep = ((p * depth).sum(-1) - farther).abs() * torch.exp(-log_scale) + log_scale
    x = (p * cells.repeat(CELLS)).sum(-1) - uv[..., 0]
    y = (p * cells.repeat_interleave(CELLS)).sum(-1) - uv[..., 1]
    off_cm = torch.hypot(x, y).detach() * INPUT_M / CELLS * 100.0
    loss = ((surprise + 0.5 * deep) * inside).sum() / inside.sum()
    return loss, (off_cm * inside).sum(0) / inside.sum(0)


def facing_loss(facing: Tensor, uv: Tensor, farther: Tensor) -> Tensor:
    """Of the direction from the right shoulder to the left one, in the picture and in depth."""
    across = (uv[:, LEFT_SHOULDER, 0] - uv[:, RIGHT_SHOULDER, 0]) * INPUT_M / CELLS
    deep = farther[:, LEFT_SHOULDER] - farther[:, RIGHT_SHOULDER]
    wanted = F.normalize(torch.stack([across, deep], 1), dim=1, eps=0.05)
    return (facing - wanted).square().sum(1).mean()


def take_over(network: Network, exported: Path, x: Tensor) -> None:
    """Begin with the weights of an exported network, in which each normalisation went into the convolution before it: it is
    set so that of this batch it gives back what it takes, and adds what that convolution had."""
    graph = onnx.load(exported).graph
    known = {one.name: torch.from_numpy(to_array(one).copy()) for one in graph.initializer}
    convolutions = [node for node in graph.node if node.op_type == "Conv"]
    weights = iter([[known[name] for name in node.input[1:3]] for node in convolutions])
    added = torch.zeros(0)

    @torch.no_grad()
    def set_convolution(module: nn.Conv2d, _: object) -> None:
        nonlocal added
        if module is not network.yaw:  # tells nothing but while training, so it is not exported
            weight, added = next(weights)
            module.weight.copy_(weight)
            if module.bias is not None:
                module.bias.copy_(added)

    @torch.no_grad()
    def set_normalisation(module: nn.BatchNorm2d, taken: tuple[Tensor]) -> None:
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


def main() -> int:
    """Train and export."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("pictures", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--minutes", type=float, default=45.0)
    parser.add_argument(
        "--onwards", type=Path, help="a network (OUT of an earlier run) to go on from"
    )
    args = parser.parse_args()
    torch.manual_seed(0)
    pictures = Pictures(args.pictures)
    network = Network().to(memory_format=torch.channels_last)
    if args.onwards is not None:
        take_over(network, args.onwards, torch.cat([pictures.batch()[0] for _ in range(8)]))
    optimiser = torch.optim.AdamW(network.parameters(), lr=2e-3, weight_decay=1e-3)
    begin_s, step, usual_cm, usual_loss = time.monotonic(), 0, torch.zeros(JOINTS), 0.0
    while (done := (time.monotonic() - begin_s) / (60.0 * args.minutes)) < 1.0:
        for group in optimiser.param_groups:
            group["lr"] = (
                2e-3 * min(1.0, step / 200.0) * 0.5 * (1.0 + math.cos(math.pi * done)) + 1e-5
            )
        x, uv, farther = pictures.batch()
        with torch.autocast("cpu", dtype=torch.bfloat16):
            maps = network(x.contiguous(memory_format=torch.channels_last))
        loss, off_cm = loss_of(maps.float(), uv, farther)
        loss = loss + facing_loss(network.facing.float(), uv, farther)
        optimiser.zero_grad()
        loss.backward()
        nn.utils.clip_grad_norm_(network.parameters(), 5.0)
        optimiser.step()
        step += 1
        usual_cm += min(0.02, 1.0 / step) * (off_cm - usual_cm) if step > 1 else off_cm
        usual_loss += min(0.02, 1.0 / step) * (loss.item() - usual_loss)
        if step % 100 == 0:
            sys.stdout.write(
                f"{100 * done:3.0f} % loss {usual_loss:.2f}, off by {usual_cm.mean():.1f} cm\n"
            )
            sys.stdout.flush()
    network.eval()
    torch.onnx.export(
        network, (torch.zeros(1, 4, INPUT_PX, INPUT_PX),), str(args.out), opset_version=17, dynamo=False,
        input_names=["picture"], output_names=["maps"],
    )  # fmt: skip
    return 0


if __name__ == "__main__":
    sys.exit(main())
