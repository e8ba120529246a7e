"""Train the network of heatmaps on pictures that lab.training.training_pictures drew; see README.md beside this.

Maps by cross-entropy with a Gaussian of 0.8 cells, depths by a Laplace distribution, the mask by cross-entropy.
"""

import argparse
import math
import sys
import time
from pathlib import Path

import torch
from torch import Tensor, nn
from torch.nn import functional as F  # noqa: N812 (its usual name)

from lab.training.batches import INPUT_M, LEFT_SHOULDER, RIGHT_SHOULDER, Pictures
from lab.training.network import CELLS, INPUT_PX, JOINTS, TOES, Network, take_over

BLUR_CELLS = 0.8
MASK_WEIGHT = 4.0


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


def overlap(odds: Tensor, mask: Tensor) -> float:
    """Intersection over union of masks (B,1,96,96)."""
    found, true = odds > 0.0, mask > 0.5
    return float((found & true).sum() / (found | true).sum().clamp(1))


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
    parser.add_argument(
        "--heads",
        action="store_true",
        help="train toes and mask alone, of the network to go on from",
    )
    args = parser.parse_args()
    torch.manual_seed(0)
    pictures = Pictures(args.pictures)
    network = Network().to(memory_format=torch.channels_last)
    if args.onwards is not None:
        take_over(network, args.onwards, torch.cat([pictures.batch()[0] for _ in range(8)]))
    if args.heads:
        network.hold_joints()
    learning = [one for one in network.parameters() if one.requires_grad]
    optimiser = torch.optim.AdamW(learning, lr=2e-3, weight_decay=1e-3)
    begin_s, step, usual_loss, usual_share = time.monotonic(), 0, 0.0, 0.0
    usual_cm = torch.zeros(JOINTS)
    while (done := (time.monotonic() - begin_s) / (60.0 * args.minutes)) < 1.0:
        for group in optimiser.param_groups:
            group["lr"] = (
                2e-3 * min(1.0, step / 200.0) * 0.5 * (1.0 + math.cos(math.pi * done)) + 1e-5
            )
        x, uv, farther, mask = pictures.batch()
        with torch.autocast("cpu", dtype=torch.bfloat16):
            maps, odds = network(x.contiguous(memory_format=torch.channels_last))
        loss, off_cm = loss_of(maps.float(), uv, farther)
        loss = loss + MASK_WEIGHT * F.binary_cross_entropy_with_logits(odds.float(), mask)
        loss = loss + facing_loss(network.facing.float(), uv, farther)
        optimiser.zero_grad()
        loss.backward()
        nn.utils.clip_grad_norm_(learning, 5.0)
        optimiser.step()
        step += 1
        usual_cm += min(0.02, 1.0 / step) * (off_cm - usual_cm) if step > 1 else off_cm
        usual_loss += min(0.02, 1.0 / step) * (loss.item() - usual_loss)
        usual_share += min(0.02, 1.0 / step) * (overlap(odds.detach(), mask) - usual_share)
        if step % 100 == 0:
            sys.stdout.write(
                f"{100 * done:3.0f} % loss {usual_loss:.2f}, off by {usual_cm.mean():.1f} cm, toes "
                f"by {usual_cm[-TOES:].mean():.1f}, mask {usual_share:.3f} over union\n"
            )
            sys.stdout.flush()
    network.eval()
    torch.onnx.export(
        network, (torch.zeros(1, 4, INPUT_PX, INPUT_PX),), str(args.out), opset_version=17, dynamo=False,
        input_names=["picture"], output_names=["maps", "mask"],
    )  # fmt: skip
    return 0


if __name__ == "__main__":
    sys.exit(main())
