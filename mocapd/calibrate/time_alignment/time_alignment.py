"""Aligns the pictures of all cameras in time: by their stamps, and by the board's motion where it contradicts them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from mocapd.calibrate.time_alignment.board_track import BoardTrack
from mocapd.calibrate.time_alignment.clock_map import SAME_CLOCK, ClockMap, clock_map
from mocapd.calibrate.time_alignment.offset_search import PairOffsets, find_offsets
from mocapd.errors import ConfigError
from mocapd.types import Floats

MENDED = 0.9  # periods; this step corrects larger offsets, the joint solution finds smaller ones
_WORTH_SAYING = 0.5  # periods
_MOST_JUMPS_PER_MINUTE = 30.0
TIME_FIX = (
    "record all cameras with one program that stamps their frames, or clap the board shut in sight of all and cut the "
    "videos there"
)


@dataclass(frozen=True, slots=True, eq=False)
class AlignedTimes:
    """times_s[camera][picture] [s] in the reference camera's time, of pictures with a reliable time.

    `maps`: by camera, from its stamps to that time. farthest_s: largest reliable offset between two cameras, including
    those that are too small to correct.
    """

    reference: str
    times_s: Mapping[str, Mapping[int, float]]
    maps: Mapping[str, ClockMap]
    period_s: Mapping[str, float]
    farthest_s: float

    def troubles(self, later_s: Mapping[str, float] | None = None) -> tuple[str, ...]:
        """Errors of the stamps for the user, by camera. later_s: additional delay [s] of each camera's exposure."""
        later_s = later_s or {}
        out = []
        for name, clock in self.maps.items():
            if not len(clock.jump_s) and not clock.offset_s.any():
                continue  # not mended
            more_s = later_s.get(name, 0.0) - later_s.get(self.reference, 0.0)
            clock = ClockMap(clock.jump_s, clock.offset_s - more_s)
            out.append(f"{name} {clock_text(clock, self.period_s[name], self.reference)}")
        return tuple(out)


def align_times(
    tracks: Mapping[str, BoardTrack], stamps_s: Mapping[str, Mapping[int, float]]
) -> AlignedTimes:
    """`stamps_s[camera][picture]`: of all pictures with the board, by the files.

    Raises ConfigError for a camera whose pictures contradict another's at the offset of their stamps, and agree at
    no other.
    """
    pairs: dict[tuple[str, str], PairOffsets] = {}
    for a, b in combinations(tracks, 2):
        offsets = find_offsets(tracks[a], tracks[b])
        if offsets is not None:
            pairs[a, b] = offsets
    reference = _reference(list(tracks), pairs)
    maps: dict[str, tuple[ClockMap, ...]] = {reference: (SAME_CLOCK,)}
    while len(maps) < len(tracks):
        placed, name = _next(list(tracks), maps, pairs)
        own = SAME_CLOCK
        if placed is not None:
            offsets = pairs.get((placed, name)) or find_offsets(tracks[placed], tracks[name])
            if offsets is not None:
                own = _checked_map(tracks, placed, name, offsets)
            maps[name] = (own, *maps[placed])
        else:
            maps[name] = (own,)
    times, merged = {}, {}
    for name in tracks:
        indices = sorted(stamps_s[name])
        stamps = np.array([stamps_s[name][index] for index in indices])
        at_s, reliable = stamps, np.ones(len(stamps), bool)
        for clock in maps[name]:
            at_s, inside = clock.times(at_s)
            reliable &= inside
        times[name] = {
            index: float(t) for index, t, good in zip(indices, at_s, reliable, strict=True) if good
        }
        merged[name] = _merge(maps[name])
    farthest_s = max(
        (float(np.abs(o.offset_s).max()) for o in pairs.values() if o.sure), default=0.0
    )
    return AlignedTimes(
        reference, times, merged, {n: track.period_s for n, track in tracks.items()}, farthest_s
    )


def clock_text(clock: ClockMap, period_s: float, other: str) -> str:
    """The offset and the jumps of a camera relative to another."""
    parts = []
    offset_s = float(clock.offset_s[0])
    if abs(offset_s) >= _WORTH_SAYING * period_s:
        # a recording that starts later has lower stamps
        side = f"behind {other} (it began later)" if offset_s < 0.0 else f"ahead of {other}"
        parts.append(
            f"is {abs(offset_s) / period_s:.1f} frames ({1e3 * abs(offset_s):.0f} ms) {side}"
        )
    for at_s, change_s in zip(clock.jump_s, clock.changes_s, strict=True):
        frames = round(abs(change_s) / period_s)
        what = "loses" if change_s < 0.0 else "repeats or gains"
        parts.append(f"{what} {frames} frame{'s' if frames != 1 else ''} near {at_s:.1f} s")
    return ", ".join(parts)


def _merge(chain: Sequence[ClockMap]) -> ClockMap:
    """Offsets and jumps of a chain of maps as one, for the user's message."""
    jump_s: Floats = np.concatenate([clock.jump_s for clock in chain])
    change_s: Floats = np.concatenate([clock.changes_s for clock in chain])
    order = np.argsort(jump_s)
    first_s = sum(float(clock.offset_s[0]) for clock in chain)
    return ClockMap(jump_s[order], first_s + np.concatenate([[0.0], np.cumsum(change_s[order])]))


def _reference(names: Sequence[str], pairs: Mapping[tuple[str, str], PairOffsets]) -> str:
    """The camera with the fewest jumps relative to the others, and the most common pictures."""

    def worth(name: str) -> tuple[int, int]:
        own = [offsets for pair, offsets in pairs.items() if name in pair and offsets.sure]
        return -sum(len(offsets.jumps) for offsets in own), sum(offsets.pairs for offsets in own)

    return max(names, key=worth)


def _next(
    names: Sequence[str], placed: Mapping[str, object], pairs: Mapping[tuple[str, str], PairOffsets]
) -> tuple[str | None, str]:
    """The most reliable pair of a placed camera and one that is not; None: no such pair."""
    best: tuple[tuple[bool, int], str, str] | None = None
    for (a, b), offsets in pairs.items():
        if (a in placed) == (b in placed):
            continue
        old, new = (a, b) if a in placed else (b, a)
        worth = (offsets.sure, offsets.pairs)
        if best is None or worth > best[0]:
            best = worth, old, new
    if best is None:
        return None, next(name for name in names if name not in placed)
    return best[1], best[2]


def _checked_map(
    tracks: Mapping[str, BoardTrack], placed: str, name: str, offsets: PairOffsets
) -> ClockMap:
    """The map by the motion, or none where that adds nothing. Raises ConfigError."""
    track = tracks[name]
    clock = clock_map(offsets)
    small = not len(clock.jump_s) and abs(float(clock.offset_s[0])) < MENDED * track.period_s
    if small or not offsets.refuted:
        return SAME_CLOCK
    said = clock_text(clock, track.period_s, placed)
    if not offsets.sure:
        raise ConfigError(f"the pictures are not of one moment: it perhaps {said}", name, TIME_FIX)
    minutes = (tracks[placed].times_s[-1] - tracks[placed].times_s[0]) / 60.0
    jumps = len(clock.jump_s)
    if jumps > max(4.0, _MOST_JUMPS_PER_MINUTE * minutes):
        raise ConfigError(
            f"its frames come out of time {jumps} times against {placed}", name, TIME_FIX
        )
    return clock
