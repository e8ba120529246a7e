"""Batches of the pictures that lab.training.training_pictures drew, altered at random."""

from pathlib import Path

import numpy as np
import torch
from torch import Tensor
from torch.nn import functional as F  # noqa: N812 (its usual name)

from lab.training.network import CELLS, INPUT_PX, JOINTS

LEFT_SHOULDER, RIGHT_SHOULDER = 3, 4
MIRROR = [0, 1, 2, 4, 3, 6, 5, 8, 7, 10, 9, 12, 11, 14, 13, 16, 15]
PICTURE_PX, PICTURE_M, INPUT_M = 128, 3.0, 2.4
BATCH = 64
FACING_THE_CAMERA = 2.5  # so many times as often as others: so people stand before cameras


class Pictures:
    """All pictures, and batches of them altered at random."""

    def __init__(self, folder: Path) -> None:
        files = [np.load(path) for path in sorted(folder.glob("*.npz"))]
        n = sum(len(one["farther"]) for one in files)
        self.pictures = torch.empty((n, PICTURE_PX, PICTURE_PX, 7), dtype=torch.uint8)
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

    def batch(self) -> tuple[Tensor, Tensor, Tensor, Tensor]:
        """Inputs (B,4,96,96), places (B,J,2) in cells, depths (B,J), masks (B,1,96,96) of the person, 0..1."""
        drawn = torch.rand(BATCH).double() * self._chances[-1]
        which = torch.searchsorted(self._chances, drawn).clamp(max=len(self.uv) - 1)
        x = self.pictures[which].permute(0, 3, 1, 2).float() / 255.0
        x, uv, farther = moved(x, self.uv[which].clone(), self.farther[which].clone())
        seen, mask = shown(x[:, :3], x[:, 3:6], x[:, 6:])
        return seen, uv, farther, mask


def moved(x: Tensor, uv: Tensor, farther: Tensor) -> tuple[Tensor, Tensor, Tensor]:
    """Cut out, larger or smaller, turned, aside, and mirrored in half of all cases."""
    n = len(x)
    size = INPUT_M / PICTURE_M * torch.exp(0.08 * torch.randn(n))
    turn, aside = 0.06 * torch.randn(n), 0.075 * torch.randn(n, 2)
    mirrored = torch.rand(n) < 0.5
    c, s, side = torch.cos(turn) * size, torch.sin(turn) * size, torch.where(mirrored, -1.0, 1.0)
    A = torch.zeros(n, 2, 3)
    A[:, 0, 0], A[:, 0, 1], A[:, 1, 0], A[:, 1, 1], A[:, :, 2] = c * side, -s, s * side, c, aside
    grid = F.affine_grid(A, [n, 7, INPUT_PX, INPUT_PX], align_corners=False)
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


def shown(picture: Tensor, room: Tensor, mask: Tensor) -> tuple[Tensor, Tensor]:
    """As another camera would: in other light, noisier, blurred, before a background that is off, behind boxes, which hide
    the person."""
    mask = mask.clone()
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
                mask[(i, 0, *box)] = 0.0
            off[(i, 0, *box)] = 0.2 * torch.rand(1)
    off = torch.where(torch.rand(n, 1, 1, 1) < 0.1, torch.zeros_like(off), off)
    return torch.cat([picture - 0.5, off.clamp(0.0, 1.0)], 1), mask
