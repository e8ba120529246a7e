"""Every sound of the game as numbers: made here, so that nothing foreign is in the package. Pure.

Mono, floats -1..1, RATE_HZ samples a second.
"""

import io
import wave

import numpy as np

from mocapd.types import Floats

RATE_HZ = 22050
_SEED = 5


def kick() -> Floats:
    """A foot against a ball: a low thump that falls, and a click."""
    t = _time(0.22)
    thump = np.sin(2 * np.pi * (95.0 * t - 130.0 * t * t)) * np.exp(-18.0 * t)
    return _loud(thump + 0.35 * _noise(t, 0.3) * np.exp(-160.0 * t), 0.8)


def slap() -> Floats:
    """A ball against gloves."""
    t = _time(0.25)
    body = np.sin(2 * np.pi * 170.0 * t) * np.exp(-30.0 * t)
    return _loud(0.6 * body + _noise(t, 0.5) * np.exp(-45.0 * t), 0.85)


def net() -> Floats:
    """A ball in the net: a rustle."""
    t = _time(0.6)
    return _loud(
        _noise(t, 0.7) * np.exp(-6.0 * t) * (0.6 + 0.4 * np.sin(2 * np.pi * 23.0 * t)), 0.4
    )


def cheer() -> Floats:
    """Many people are glad: noise through the vowel of an open mouth, swelling and fading."""
    t = _time(1.8)
    voices = _band(_noise(t, 0.0), 500.0, 1100.0) + 0.6 * _band(_noise(t, 0.1), 1100.0, 2400.0)
    return _loud(voices * np.minimum(t / 0.18, 1.0) * np.exp(-1.6 * np.maximum(t - 0.5, 0.0)), 0.6)


def groan() -> Floats:
    """Many people are not."""
    t = _time(1.5)
    voices = _band(_noise(t, 0.2), 180.0, 420.0)
    return _loud(voices * np.minimum(t / 0.12, 1.0) * np.exp(-2.2 * t), 0.5)


def beep(high: bool) -> Floats:
    """The countdown; high: go."""
    t = _time(0.55 if high else 0.16)
    tone = np.sin(2 * np.pi * (1046.5 if high else 523.25) * t)
    return _loud(tone * np.minimum(t / 0.005, 1.0) * np.exp(-(4.0 if high else 9.0) * t), 0.4)


def whistle() -> Floats:
    """The referee's, three times: two tones that beat, with a pea in it."""
    t = _time(0.42)
    trill = 1.0 + 0.012 * np.sin(2 * np.pi * 38.0 * t)
    phase = 2 * np.pi * np.cumsum(2350.0 * trill) / RATE_HZ
    once = (np.sin(phase) + 0.6 * np.sin(1.06 * phase)) * np.minimum(t / 0.02, 1.0)
    once *= np.minimum((t[-1] - t) / 0.04, 1.0)
    pause = np.zeros(int(0.08 * RATE_HZ))
    return _loud(np.concatenate([once, pause, once, pause, once, once * 0.9]), 0.35)


def murmur(seconds: float = 6.0) -> Floats:
    """The stands while nothing happens; its end runs into its beginning."""
    t = _time(seconds)
    voices = _band(_noise(t, 0.4), 200.0, 900.0)
    swell = 1.0 + 0.25 * np.sin(2 * np.pi * t / seconds) + 0.15 * np.sin(6 * np.pi * t / seconds)
    return _loud(voices * swell, 0.16)


def wav(samples: Floats) -> bytes:
    """A WAV file of 16 bits."""
    out = io.BytesIO()
    with wave.open(out, "wb") as file:
        file.setnchannels(1)
        file.setsampwidth(2)
        file.setframerate(RATE_HZ)
        file.writeframes(np.rint(32767 * np.clip(samples, -1.0, 1.0)).astype("<i2").tobytes())
    return out.getvalue()


def _time(seconds: float) -> Floats:
    return np.arange(int(seconds * RATE_HZ)) / RATE_HZ


def _noise(t: Floats, which: float) -> Floats:
    return np.random.default_rng([_SEED, round(10 * which)]).uniform(-1.0, 1.0, len(t))


def _band(samples: Floats, low_hz: float, high_hz: float) -> Floats:
    """What lies between two frequencies; the transform makes it run round without a seam."""
    spectrum = np.fft.rfft(samples)
    hz = np.fft.rfftfreq(len(samples), 1.0 / RATE_HZ)
    middle, width = np.sqrt(low_hz * high_hz), np.log(high_hz / low_hz) / 2
    spectrum *= np.exp(-0.5 * (np.log(np.maximum(hz, 1.0) / middle) / width) ** 2)
    out: Floats = np.fft.irfft(spectrum, len(samples))
    return out


def _loud(samples: Floats, peak: float) -> Floats:
    out: Floats = peak * samples / max(float(np.abs(samples).max()), 1e-9)
    return out
