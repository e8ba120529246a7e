"""Train the network of heatmaps on pictures that lab.training.training_pictures draws; see README.md beside this.

Maps by cross-entropy with a Gaussian of 0.8 cells, depths by a Laplace distribution, the mask by cross-entropy. What is
kept is the mean of the last thousand steps' weights or so.
"""

import argparse
import math
import sys
import time
from collections.abc import Sequence
from pathlib import Path

import torch
from torch import Tensor, nn
from torch.nn import functional as F  # noqa: N812 (its usual name)
from torch.optim.swa_utils import AveragedModel, get_ema_multi_avg_fn

from lab.training.batches import INPUT_M, LEFT_SHOULDER, RIGHT_SHOULDER, Pictures, altered
from lab.training.network import CELLS, INPUT_PX, JOINTS, TOES, Network
from lab.training.warm_start import begin_with

BLUR_CELLS = 0.8
MASK_WEIGHT = 4.0
_RATE, _RATE_AT_LAST = 7e-4, 5e-6
_WARM_UP, _KEPT = 500, 0.999  # steps; of the mean at each step
_TOLD = 100  # steps


def loss_of(maps: Tensor, uv: Tensor, farther: Tensor) -> tuple[Tensor, Tensor]:
    """The loss of a batch, and how far off each joint is (J,) [cm]."""
    odds, depth, scale = (one.flatten(2) for one in maps.split(JOINTS, 1))
    p = F.softmax(odds, -1)
    cells = torch.arange(CELLS, device=maps.device).float()
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


def overlap(odds: Tensor, mask: Tensor) -> Tensor:
    """Intersection over union of masks (B,1,96,96)."""
    found, true = odds > 0.0, mask > 0.5
    return (found & true).sum() / (found | true).sum().clamp(1)


class Training:
    """One network, how it learns, and the mean of its weights."""

    def __init__(self, network: Network, device: str) -> None:
        self.network = network.to(device, memory_format=torch.channels_last)
        self.mean = AveragedModel(
            self.network, multi_avg_fn=get_ema_multi_avg_fn(_KEPT), use_buffers=True
        )
        self._compiled = torch.compile(self._loss) if device == "cuda" else self._loss
        self._optimiser = torch.optim.AdamW(network.parameters(), lr=_RATE, weight_decay=1e-3)
        self._usual: Tensor | None = None

    def learn(self, rate: float, *batch: Tensor) -> None:
        """One step; batch: as `altered` makes it."""
        for group in self._optimiser.param_groups:
            group["lr"] = rate
        loss, figures = self._compiled(*batch)
        self._optimiser.zero_grad()
        loss.backward()
        nn.utils.clip_grad_norm_(self.network.parameters(), 5.0)
        self._optimiser.step()
        self.mean.update_parameters(self.network)
        self._usual = figures if self._usual is None else self._usual.lerp(figures, 0.02)

    @property
    def said(self) -> str:
        """How well it does of late."""
        if self._usual is None:
            return "nothing learned"
        loss, share, off_cm = self._usual[0], self._usual[1], self._usual[2:]
        return (
            f"loss {loss:.3f}, off by {off_cm.mean():.2f} cm, toes by {off_cm[-TOES:].mean():.2f}, "
            f"wrists by {off_cm[7:9].mean():.2f}, mask {share:.4f} over union"
        )

    def export(self, path: Path) -> None:
        """The mean as a file that OpenCV reads."""
        network = Network(*self.network.sizes)
        network.load_state_dict(
            {name: value.cpu() for name, value in self.mean.module.state_dict().items()}
        )
        network.eval()
        torch.onnx.export(
            network, (torch.zeros(1, 4, INPUT_PX, INPUT_PX),), str(path), opset_version=17, dynamo=False,
            input_names=["picture"], output_names=["maps", "mask"],
        )  # fmt: skip

    def _loss(self, x: Tensor, uv: Tensor, farther: Tensor, mask: Tensor) -> tuple[Tensor, Tensor]:
        with torch.autocast(x.device.type, dtype=torch.bfloat16):
            maps, odds, facing = self.network.told(x.contiguous(memory_format=torch.channels_last))
        loss, off_cm = loss_of(maps.float(), uv, farther)
        loss = loss + MASK_WEIGHT * F.binary_cross_entropy_with_logits(odds.float(), mask)
        loss = loss + facing_loss(facing.float(), uv, farther)
        share = overlap(odds.detach(), mask)
        return loss, torch.cat([torch.stack([loss.detach(), share]), off_cm])


def train(trainings: Sequence[Training], pictures: Pictures, minutes: float, size: int) -> None:
    """All of them on the same batches of this size."""
    begin_s, step = time.monotonic(), 0
    alter = torch.compile(altered) if pictures.device == "cuda" else altered
    while (done := (time.monotonic() - begin_s) / (60.0 * minutes)) < 1.0:
        slope = min(1.0, step / _WARM_UP) * 0.5 * (1.0 + math.cos(math.pi * done))
        batch = alter(*pictures.batch(size))
        for training in trainings:
            training.learn(_RATE * slope + _RATE_AT_LAST, *batch)
        step += 1
        if step % _TOLD == 0:
            told = "; ".join(training.said for training in trainings)
            sys.stdout.write(
                f"{100 * done:3.0f} % step {step} of {pictures.drawn} pictures: {told}\n"
            )
            sys.stdout.flush()


def main() -> int:
    """Train and export."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("pictures", type=Path, help="a folder that may still be filled")
    parser.add_argument("out", type=Path)
    parser.add_argument(
        "--begin", type=Path, help="a trained network, as wide or narrower, to go on from"
    )
    parser.add_argument("--minutes", type=float, default=45.0)
    parser.add_argument("--device", default="cuda" if torch.cuda.is_available() else "cpu")
    parser.add_argument("--batch", type=int, default=128)
    parser.add_argument("--most", type=int, default=100_000, help="pictures held in memory")
    parser.add_argument("--discard", action="store_true", help="delete files that were read")
    args = parser.parse_args()
    torch.manual_seed(0)
    pictures = Pictures(args.pictures, args.most, args.device, discard=args.discard)
    network = Network()
    if args.begin is not None:
        begin_with(network, args.begin)
    training = Training(network, args.device)
    train([training], pictures, args.minutes, args.batch)
    training.export(args.out)
    return 0


if __name__ == "__main__":
    sys.exit(main())
