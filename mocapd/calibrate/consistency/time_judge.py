"""Checks the times of cameras' pictures by common motion."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from mocapd.calibrate.consistency.findings import CaptureFinding, Mistake
from mocapd.calibrate.consistency.motion_delay import CameraDelay, MotionSignal, camera_delays

# limits of a reliable delay: least agreement, largest agreement of the next best, largest deviation
_AGREEMENT, _RIVAL, _SD_S = 0.45, 0.85, 0.034
_GAIN = 0.02  # in agreement, of a delay
_LEAST_S = 0.018  # over half a frame at 30 Hz
_SURE_SDS = 3.0
_PART_S = 5.0  # parts of a recording for separate delays
_JUMP_S = 0.05  # least change of a delay after dropped frames
_ALIKE = 0.55  # agreement of cameras that certainly see the same movement
# A recording's true rate over the rate of its times, of common mistakes
_RATES = (0.5, 0.6, 2 / 3, 0.8, 5 / 6, 0.96, 25 / 24, 1.2, 1.25, 1.5, 5 / 3, 2.0)
# least agreement of a corrected rate, and least gain over the given rates
_RATE_AGREEMENT, _RATE_GAIN = 0.6, 0.2
_RATE_NEAR = 0.06  # of the logarithm: rates that are no rivals


@dataclass(frozen=True, slots=True, eq=False)
class CameraTiming:
    """A camera's motion, and the mean period of its frames [s]."""

    name: str
    signal: MotionSignal
    period_s: float


@dataclass(frozen=True, slots=True, eq=False)
class TimeVerdict:
    """findings: of cameras with wrong times; moves_alike: by camera, whether its motion coincides with the others' once
    their times are corrected."""

    findings: tuple[CaptureFinding, ...]
    moves_alike: tuple[bool, ...]


def judge_times(cameras: Sequence[CameraTiming]) -> TimeVerdict:
    """Findings of each camera whose times are certainly early or late, or have a jump."""
    delays = camera_delays([camera.signal for camera in cameras])
    jumps = _jumps(cameras, delays)
    rate = None if any(jumps) else _wrong_rate(cameras, delays)
    if rate is not None:
        return TimeVerdict((rate,), (True,) * len(cameras))
    findings = tuple(_late_findings(cameras, delays, jumps))
    concerned = {name for finding in findings for name in finding.cameras}
    alike = tuple(
        camera.name in concerned
        or (delay is not None and _is_reliable(delay) and delay.agreement > _ALIKE)
        for camera, delay in zip(cameras, delays, strict=True)
    )
    # of a pair the first camera is the reference of delays
    return TimeVerdict(findings, (all(alike),) * 2 if len(alike) == 2 else alike)


def _late_findings(
    cameras: Sequence[CameraTiming],
    delays: Sequence[CameraDelay | None],
    jumps: Sequence[tuple[float, float] | None],
) -> Iterator[CaptureFinding]:
    for camera, delay, jump in zip(cameras, delays, jumps, strict=True):
        if jump is not None:
            yield _jump_finding(camera, *jump)
        elif delay is not None and _is_reliable(delay) and _is_late(delay):
            yield _late(camera, delay)


def _is_reliable(delay: CameraDelay) -> bool:
    return (
        delay.sd_s < _SD_S
        and delay.agreement > _AGREEMENT
        and delay.rival < _RIVAL * delay.agreement
    )


def _is_late(delay: CameraDelay) -> bool:
    return (
        abs(delay.late_s) > max(_LEAST_S, _SURE_SDS * delay.sd_s)
        and delay.agreement_undelayed < delay.agreement - _GAIN
    )


def _wrong_rate(
    cameras: Sequence[CameraTiming], delays: Sequence[CameraDelay | None]
) -> CaptureFinding | None:
    """A camera whose motion coincides with the others' once its times are stretched, and not as given."""
    signals = [camera.signal for camera in cameras]
    before = _agreement(delays)
    tried: list[tuple[float, int, float, CameraDelay]] = []
    for i, delay in enumerate(delays):
        if delay is not None and _is_reliable(delay) and delay.agreement > _RATE_AGREEMENT:
            continue
        for stretch in _RATES:
            times_s = signals[i].times_s * stretch
            changed = [*signals[:i], MotionSignal(times_s, signals[i].change), *signals[i + 1 :]]
            after = camera_delays(changed)
            mine = after[i]
            if mine is not None:
                tried.append((_agreement(after), i, stretch, mine))
    if not tried:
        return None
    total, i, stretch, delay = max(tried, key=lambda entry: entry[0])
    rivals = [
        other.agreement
        for _, k, by, other in tried
        if k == i and abs(np.log(by / stretch)) > _RATE_NEAR
    ]
    was = delays[i]
    if (
        not _is_reliable(delay)
        or delay.agreement < max(_RATE_AGREEMENT, _RATE_GAIN + (was.agreement if was else 0.0))
        or total < before
        or max(rivals, default=0.0) > _RIVAL * delay.agreement
    ):
        return None
    # of two cameras either may be wrong
    names = tuple(camera.name for camera in cameras) if len(cameras) == 2 else (cameras[i].name,)
    return CaptureFinding(
        Mistake.DELAY,
        names,
        f"what moves in the pictures of {cameras[i].name!r} takes {1.0 / stretch:.2f} times as long as the others show: "
        "the rate that its times say is not the one at which it was recorded",
        "record all cameras with their frames' own times, or store the video with its true rate",
    )


def _agreement(delays: Sequence[CameraDelay | None]) -> float:
    """The sum over cameras with a reliable delay."""
    return sum(delay.agreement for delay in delays if delay is not None and _is_reliable(delay))


def _jumps(
    cameras: Sequence[CameraTiming], whole: Sequence[CameraDelay | None]
) -> list[tuple[float, float] | None]:
    """For each camera, reliable delays of the first and the last part of the recording, where they differ.

    A part counts if it agrees better than the whole recording, which one delay cannot explain after a jump; in a quiet part
    noise agrees a little at any delay.
    """
    begin = max(camera.signal.times_s.min(initial=np.inf) for camera in cameras)
    end = min(camera.signal.times_s.max(initial=-np.inf) for camera in cameras)
    if end - begin < 1.5 * _PART_S:
        return [None] * len(cameras)
    parts = [
        camera_delays([_part(camera.signal, low, low + _PART_S) for camera in cameras])
        for low in np.arange(begin, end - _PART_S + 1e-6, 0.25 * _PART_S)
    ]
    out: list[tuple[float, float] | None] = []
    for i in range(len(cameras)):
        least = one.agreement if (one := whole[i]) is not None else _AGREEMENT
        there = [one for part in parts if (one := part[i]) is not None and one.agreement > least]
        late_s = [delay.late_s for delay in there if _is_reliable(delay)]
        changed = len(late_s) > 1 and abs(late_s[-1] - late_s[0]) > _JUMP_S
        out.append((late_s[0], late_s[-1]) if changed else None)
    return out


def _part(signal: MotionSignal, low_s: float, high_s: float) -> MotionSignal:
    inside = (signal.times_s >= low_s) & (signal.times_s < high_s)
    return MotionSignal(signal.times_s[inside], signal.change[inside])


def _late(camera: CameraTiming, delay: CameraDelay) -> CaptureFinding:
    frames, sense = abs(delay.late_s) / camera.period_s, "later" if delay.late_s > 0 else "earlier"
    return CaptureFinding(
        Mistake.DELAY,
        (camera.name,),
        f"the pictures of {camera.name!r} are {frames:.1f} frames ({1e3 * abs(delay.late_s):.0f} ms) {sense} than their "
        "times say, by what moves in all cameras",
        f"add {delay.late_s:+.3f} to its 'time_offset_s' in rig.json",
        delay.late_s,
    )


def _jump_finding(camera: CameraTiming, first_s: float, last_s: float) -> CaptureFinding:
    frames = abs(last_s - first_s) / camera.period_s
    return CaptureFinding(
        Mistake.DELAY,
        (camera.name,),
        f"the pictures of {camera.name!r} go out of step by {frames:.0f} frames ({1e3 * abs(last_s - first_s):.0f} ms) "
        "during the recording: frames were dropped, or its rate is another one",
        "record it with its frames' own times, or cut the videos where they are out of step",
    )
