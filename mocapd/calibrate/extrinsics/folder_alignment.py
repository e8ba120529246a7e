"""Groups the pictures with the board of a folder of recordings by instant."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from mocapd.calibrate.board.back_side import usual_back
from mocapd.calibrate.board.board_detection import BoardView
from mocapd.calibrate.board.board_recordings import RecordingTimes
from mocapd.calibrate.extrinsics.pose_graph import board_poses, camera_from_board
from mocapd.calibrate.intrinsics.intrinsics import Intrinsics
from mocapd.calibrate.time_alignment.board_track import BoardTrack, board_track
from mocapd.calibrate.time_alignment.instants import IN_STEP, Instants, gather
from mocapd.calibrate.time_alignment.time_alignment import AlignedTimes, align_times
from mocapd.types import Floats

_FOLLOWED_GAP = 2.6  # instants between positions for estimating the board's motion


@dataclass(frozen=True, slots=True, eq=False)
class AlignedViews:
    """`longest_gap` [instants]: between positions for estimating the board's motion."""

    instants: Instants
    times: AlignedTimes
    longest_gap: float

    def delay_frames(self, name: str, first: str, delay: float) -> float:
        """How much later a camera exposes than `first` in pictures of one stamp [its frames], given the `delay`
        [instants] of the joint solution."""
        later_s = float(self.times.maps[first].offset_s[0] - self.times.maps[name].offset_s[0])
        return (later_s + delay * self.instants.period_s) / self.times.period_s[name]


def align_views(
    views: Mapping[str, Mapping[int, BoardView]],
    intrinsics_of: Mapping[str, Intrinsics],
    clocks: Mapping[str, RecordingTimes],
    board_m: Floats,
    most: int,
    kept: int | None = None,
) -> AlignedViews:
    """`views[camera][index]` by instant, at most so many instants, and that of the picture `kept`. Raises ConfigError, see
    `align_times`."""
    stamps_s, tracks = {}, {}
    for name, own in views.items():
        stamps = clocks[name].stamps_s
        # a video may have one more frame than stamps
        stamps_s[name] = {i: stamps[i] for i in own if i in stamps}
        tracks[name] = _track(own, stamps_s[name], intrinsics_of[name], clocks[name], board_m)
    times = align_times(tracks, stamps_s)
    followed = any(track.followed for track in tracks.values())
    period_s = max(track.step_s for track in tracks.values())
    start_s = min(clocks[times.reference].stamps_s.values())
    # parts of a frame matter only in motion
    in_step = all(t.followed for t in tracks.values()) and times.farthest_s < IN_STEP * period_s
    instants = gather(views, times.times_s, period_s, start_s, most, in_step, kept)
    return AlignedViews(instants, times, _FOLLOWED_GAP if followed else 1.5)


def _track(
    views: Mapping[int, BoardView],
    stamps_s: Mapping[int, float],
    intrinsics: Intrinsics,
    clock: RecordingTimes,
    board_m: Floats,
) -> BoardTrack:
    back = usual_back(board_m)
    poses = {
        index: camera_from_board(pose, back)
        for index, pose in board_poses(
            {i: view for i, view in views.items() if i in stamps_s}, intrinsics, board_m
        ).items()
    }
    low, high = board_m.min(axis=0), board_m.max(axis=0)
    outline_m = np.array(
        [[x, y, 0.0] for y in (low[1], high[1]) for x in (low[0], high[0])], dtype=float
    )
    # the examined pictures, of which some show no board: pictures of a folder are one position each
    every = int(np.gcd.reduce(np.diff(sorted(stamps_s)))) if len(stamps_s) > 1 else 1
    step_s = every * clock.period_s
    focal_px = float(np.mean(np.diag(intrinsics.K)[:2]))
    return board_track(poses, stamps_s, outline_m, focal_px, clock.period_s, step_s)
