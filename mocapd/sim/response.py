"""The camera's response curve and its noise."""

import numpy as np

from mocapd.sim.scenario import CameraSpec
from mocapd.types import Bytes, Singles

_ENTRIES = 1 << 15
_NOISE = 1 << 19


def response_curve(camera: CameraSpec) -> Bytes:
    """8-bit values for signals 0..2: gamma, a shoulder, and clipping at full scale."""
    signal = np.linspace(0.0, 2.0, _ENTRIES)
    s = camera.shoulder
    # beyond the shoulder the rest of the range is approached exponentially, with equal slope
    room = max(1.0 - s, 1e-6)
    bent = np.where(signal > s, 1.0 - room * np.exp(-(signal - s) / room), signal)
    return np.round(255.0 * np.clip(bent, 0.0, 1.0) ** (1.0 / camera.gamma)).astype(np.uint8)


def noise_table(seed: int, camera_index: int) -> Singles:
    """Normal deviates that every frame of the camera enters at places of its own."""
    rng = np.random.default_rng([seed, 4, camera_index])
    return rng.standard_normal(_NOISE, dtype=np.float32)
