"""Batches of the pictures that lab.training.training_pictures drew, altered at random, on the processor that trains."""

import threading
import time
from pathlib import Path

import numpy as np
import torch
from torch import Tensor
from torch.nn import functional as F  # noqa: N812 (its usual name)

from lab.training.network import CELLS, INPUT_PX, JOINTS

LEFT_SHOULDER, RIGHT_SHOULDER = 3, 4
MIRROR = [0, 1, 2, 4, 3, 6, 5, 8, 7, 10, 9, 12, 11, 14, 13, 16, 15]
PICTURE_PX, PICTURE_M, INPUT_M = 128, 3.0, 2.4
FACING_THE_CAMERA = 2.0  # so many times as often as others: so people stand before cameras
_BOXES = 3  # at most, that hide somebody in a picture
_REST_S = 0.5  # between looks for new files


class Pictures:
    """The newest `most` pictures of a folder that may still be filled, and batches of them."""

    def __init__(self, folder: Path, most: int, device: str, *, discard: bool) -> None:
        """discard: files are deleted once they are read, where all of them together would not fit."""
        self._pictures = torch.empty(
            (most, PICTURE_PX, PICTURE_PX, 7), dtype=torch.uint8, device=device
        )
        self._places = torch.empty((most, JOINTS, 3), device=device)
        self._weights = torch.zeros(most, device=device)
        self.device, self._folder, self._discard = device, folder, discard
        self._read: set[Path] = set()
        self.drawn = 0
        while not self._read_new():
            time.sleep(_REST_S)
        threading.Thread(target=self._follow, daemon=True).start()

    def batch(self, size: int) -> tuple[Tensor, Tensor, Tensor]:
        """Pictures (B,7,128,128), 0..1; places (B,J,2) of joints in them [px]; depths (B,J) [m]."""
        which = torch.multinomial(self._weights, size, replacement=True)
        x = self._pictures[which].permute(0, 3, 1, 2).float() / 255.0
        places = self._places[which]
        return x, places[..., :2], places[..., 2]

    def _follow(self) -> None:
        while True:
            if not self._read_new():
                time.sleep(_REST_S)

    def _read_new(self) -> bool:
        """Whether there was any."""
        paths = sorted(set(self._folder.glob("*.npz")) - self._read)
        for path in paths:
            with np.load(path) as data:
                self._add(data["pictures"], data["uv"], data["farther"])
            self._read.add(path)
            if self._discard:
                path.unlink()
        return bool(paths)

    def _add(self, pictures: np.ndarray, uv: np.ndarray, farther: np.ndarray) -> None:
        n, most = len(pictures), len(self._pictures)
        at = (self.drawn + torch.arange(n)) % most
        at = at.to(self._pictures.device)
        places = torch.from_numpy(np.concatenate([uv, farther[..., None]], axis=2))
        facing = places[:, LEFT_SHOULDER, 0] > places[:, RIGHT_SHOULDER, 0]
        self._pictures[at] = torch.from_numpy(pictures).to(self._pictures.device)
        self._places[at] = places.float().to(self._pictures.device)
        self._weights[at] = torch.where(facing, FACING_THE_CAMERA, 1.0).to(self._pictures.device)
        self.drawn += n


def altered(x: Tensor, uv: Tensor, farther: Tensor) -> tuple[Tensor, Tensor, Tensor, Tensor]:
    """Inputs (B,4,96,96), places (B,J,2) in cells, depths (B,J), masks (B,1,96,96) of the person, 0..1."""
    x, uv, farther = _moved(x, uv, farther)
    seen, mask = _shown(x[:, :3], x[:, 3:6], x[:, 6:])
    return seen, uv, farther, mask


def _moved(x: Tensor, uv: Tensor, farther: Tensor) -> tuple[Tensor, Tensor, Tensor]:
    """Cut out, larger or smaller, turned, aside (some far: a body is lost), and mirrored in half of all cases."""
    n, at = len(x), x.device
    lost = 1.0 + 1.0 * (torch.rand(n, device=at) < 0.1)
    size = INPUT_M / PICTURE_M * torch.exp(0.08 * lost * torch.randn(n, device=at))
    turn = 0.06 * lost * torch.randn(n, device=at)
    aside = 0.075 * lost[:, None] * torch.randn(n, 2, device=at)
    mirrored = torch.rand(n, device=at) < 0.5
    c, s, side = torch.cos(turn) * size, torch.sin(turn) * size, torch.where(mirrored, -1.0, 1.0)
    A = torch.stack(
        [torch.stack([c * side, -s, aside[:, 0]], 1), torch.stack([s * side, c, aside[:, 1]], 1)], 1
    )
    grid = F.affine_grid(A, [n, 7, INPUT_PX, INPUT_PX], align_corners=False)
    x = F.grid_sample(x, grid, mode="bilinear", padding_mode="border", align_corners=False)
    off = (uv + 0.5) / PICTURE_PX * 2.0 - 1.0 - A[:, None, :, 2]
    determinant = (A[:, 0, 0] * A[:, 1, 1] - A[:, 0, 1] * A[:, 1, 0])[:, None]
    u = (A[:, 1, 1, None] * off[..., 0] - A[:, 0, 1, None] * off[..., 1]) / determinant
    v = (A[:, 0, 0, None] * off[..., 1] - A[:, 1, 0, None] * off[..., 0]) / determinant
    uv = (torch.stack([u, v], -1) + 1.0) / 2.0 * CELLS - 0.5
    m = mirrored[:, None]
    return (
        x,
        torch.where(m[..., None], uv[:, MIRROR], uv),
        torch.where(m, farther[:, MIRROR], farther),
    )


def _shown(picture: Tensor, room: Tensor, mask: Tensor) -> tuple[Tensor, Tensor]:
    """As another camera would: other clothes, in other light, noisier, blurred, before a background that is off or knows a
    ghost, behind boxes, which hide the person."""
    n, at = len(picture), picture.device

    def some(share: float) -> Tensor:
        return torch.rand(n, 1, 1, 1, device=at) < share

    def normal(sd: float, *shape: int) -> Tensor:
        return sd * torch.randn(n, *(shape or (1, 1, 1)), device=at)

    striped = some(0.25).flatten()
    cloth = _cloth(int(striped.sum()), at)
    picture = picture.clone()
    picture[striped] *= 1.0 + mask[striped] * (cloth - 1.0)
    ghost = picture.roll(1, 0) * mask.roll(1, 0) + room * (1.0 - mask.roll(1, 0))
    room = torch.where(some(0.05), ghost, room)
    patchy = F.interpolate(
        normal(0.06, 1, 4, 4), size=INPUT_PX, mode="bilinear", align_corners=False
    )
    room = room * torch.exp(normal(0.03, 3, 1, 1) + normal(0.04) + patchy * some(0.4))
    off = ((picture - room).abs().amax(1, keepdim=True) * 4.0).clamp(0.0, 1.0)
    gain = torch.exp(normal(0.25) + normal(0.1, 3, 1, 1))
    picture = (picture.clamp(1e-3, 1.0) ** torch.exp(normal(0.2)) * gain).clamp(0.0, 1.0)
    grey = picture.mean(1, keepdim=True)
    smeared = some(0.5).flatten()  # webcams tell colours at half the size, or less
    picture[smeared] = grey[smeared] + _blurred((picture - grey)[smeared])
    colourless, unsharp = some(0.12).flatten(), some(0.25).flatten()
    picture[colourless] = grey[colourless].expand(-1, 3, -1, -1)
    picture[unsharp] = _blurred(picture[unsharp])
    noise = 0.03 * torch.rand(n, 1, 1, 1, device=at)
    picture = picture + noise * torch.randn_like(picture)
    off = off + 0.06 * torch.rand(n, 1, 1, 1, device=at) * torch.randn_like(off)
    boxed = some(0.35)
    for i in range(_BOXES):
        box = _box(n, at) & boxed & (some(0.5) if i else True)
        unlike, hidden = some(0.5), some(0.5)
        off = torch.where(
            box, torch.where(unlike, 1.0, 0.2) * torch.rand(n, 1, 1, 1, device=at), off
        )
        hides = box & ~unlike & hidden
        picture = torch.where(hides, torch.rand(n, 3, 1, 1, device=at), picture)
        mask = torch.where(hides, 0.0, mask)
    off = torch.where(some(0.1), 0.0, off)
    return torch.cat([picture - 0.5, off.clamp(0.0, 1.0)], 1), mask


def _blurred(x: Tensor) -> Tensor:
    """Means of 3x3 pixels, nothing being beyond the border."""
    for axis in (2, 3):
        after, before = x.roll(1, axis), x.roll(-1, axis)
        after.select(axis, 0).zero_()
        before.select(axis, -1).zero_()
        x = (x + after + before) / 3.0
    return x


def _cloth(n: int, at: torch.device) -> Tensor:
    """Stripes of any colour, width and direction, (B,3,96,96) about 1; crossed by others in half of the cases."""
    row = torch.arange(INPUT_PX, device=at, dtype=torch.float32)

    def stripes() -> Tensor:
        way, wide = (
            6.28 * torch.rand(n, 1, 1, device=at),
            0.25 + 1.25 * torch.rand(n, 1, 1, device=at),
        )
        across = torch.cos(way) * row + torch.sin(way) * row[:, None]
        return torch.sin(wide * across + 6.28 * torch.rand(n, 1, 1, device=at))[:, None]

    crossed = torch.rand(n, 1, 1, 1, device=at) < 0.5
    wave = torch.where(crossed, stripes() * stripes(), stripes()).mul(3.0).clamp(-1.0, 1.0)
    return torch.exp(0.4 * torch.randn(n, 3, 1, 1, device=at) * wave)


def _box(n: int, at: torch.device) -> Tensor:
    """Of 4 to 28 pixels each way, anywhere (B,1,96,96)."""
    row = torch.arange(INPUT_PX, device=at)
    size = torch.randint(4, 28, (n, 2, 1), device=at)
    begin = (torch.rand(n, 2, 1, device=at) * (INPUT_PX - size)).floor()
    inside = (row >= begin) & (row < begin + size)
    return (inside[:, 0, :, None] & inside[:, 1, None, :])[:, None]
