"""From linear light to the camera's 8-bit values."""

from typing import NamedTuple

import numpy as np

from mocapd.kernels.decorator import kernel
from mocapd.sim.person.figure_kernels import shadow_at
from mocapd.sim.scenery.pattern_kernels import hash01
from mocapd.types import Bytes, Floats, Singles


class PersonLayer(NamedTuple):
    """colour (H,W,3) linear RGB times cover, cover (H,W) 0..1; all of it within box x0 y0 x1 y1."""

    colour: Singles
    cover: Singles
    box: tuple[int, int, int, int]


class Sensor(NamedTuple):
    """gains (3,) RGB; noise: a table of normal deviates; curve maps signal 0..2, as its index does, to
    8-bit values."""

    gains: Singles
    vignetting: float
    shot: float
    read: float
    noise: Singles
    curve: Bytes


@kernel
def shade_room(points: Singles, views: Floats, depths: Singles, step: int, out: Singles) -> None:
    """The person's shadow on the room: out (L,H/step,W/step) 0..1, points (H,W,3) in the world [m]."""
    for j in range(out.shape[1]):
        for i in range(out.shape[2]):
            x = float(points[step * j, step * i, 0])
            y = float(points[step * j, step * i, 1])
            z = float(points[step * j, step * i, 2])
            for k in range(out.shape[0]):
                dark = 0.0
                if np.isfinite(x):
                    dark = shadow_at(views, depths, k, x, y, z, 0.05)
                out[k, j, i] = dark


@kernel(fastmath=True)
def expose(
    room: Singles, layers: Singles, levels: Singles, shade: Singles, person: PersonLayer,
    sensor: Sensor, noise_key: int, out: Bytes,
) -> None:  # fmt: skip
    """The picture out (H,W,3) BGR of the lit room (H,W,3) linear RGB with the person over it.

    levels (L,) and shade (L,H,W) 0..1 take the person's shadow out of the room's layers
    (L+1,H,W,3). The table of noise is entered at a place that hangs on noise_key and the row.
    """
    colour, cover, box = person
    gains, vignetting, shot, read, noise, curve = sensor
    height, width = cover.shape
    n = 3 * width
    last = len(curve) - 1
    scale, zero, top = np.float32(0.5 * last), np.float32(0.0), np.float32(last)
    x0, y0, x1, y1 = box
    row = np.empty(n, dtype=np.float32)
    off_axis = np.empty(n, dtype=np.float32)
    gain = np.empty(n, dtype=np.float32)
    r2_max = 0.25 * (width * width + height * height)
    for i in range(n):
        off_axis[i] = vignetting * (i // 3 - 0.5 * width) ** 2 / r2_max
        gain[i] = gains[i % 3]
    shot2, read2 = np.float32(shot * shot), np.float32(read * read)
    for y in range(height):
        line = room[y].ravel()
        for i in range(n):
            row[i] = line[i]
        for k in range(len(levels)):
            for x in range(width):
                dim = levels[k] * shade[k, y, x]
                if dim > 0.0:
                    for c in range(3):
                        row[3 * x + c] -= dim * layers[k + 1, y, x, c]
        if y0 <= y < y1:
            for x in range(x0, x1):
                seen = np.float32(1.0) - cover[y, x]
                for c in range(3):
                    row[3 * x + c] = seen * row[3 * x + c] + colour[y, x, c]
        full = np.float32(1.0 - vignetting * (y - 0.5 * height) ** 2 / r2_max)
        start = int(hash01(y, noise_key, 77) * (len(noise) - n))
        deviates = noise[start : start + n]
        for i in range(n):
            signal = max(row[i] * gain[i] * (full - off_axis[i]), zero)
            signal += np.sqrt(read2 + shot2 * signal) * deviates[i]
            row[i] = min(max(signal * scale, zero), top)
        for x in range(width):
            for c in range(3):
                out[y, x, 2 - c] = curve[int(row[3 * x + c])]
