"""What is written, heard and where it is seen, without the graphics library."""

import io
import subprocess
import sys
import wave

import numpy as np
import pytest

from goalkeeper.app.high_scores import HighScore, Placed
from goalkeeper.app.hud_text import PlayerSettings, Popups, hud_text, level_of, next_difficulty
from goalkeeper.app.latency import Latency
from goalkeeper.core.ball import Outcome
from goalkeeper.core.events import Saved
from goalkeeper.core.match import Match, MatchRules, Phase
from goalkeeper.core.scoring import Score
from goalkeeper.render import pictures
from goalkeeper.render.panda_space import PANDA_FROM_GOAL, to_panda
from goalkeeper.sound import synth
from goalkeeper.streams.sighting import StreamState
from tests.clients.goalkeeper.test_match import AT_HAND, AimedShooter, play, playing, t_pose

OK = StreamState()


def test_the_goals_frame_is_turned_and_not_mirrored() -> None:
    assert np.linalg.det(PANDA_FROM_GOAL) == pytest.approx(1.0)
    # left hand up, stepping left, facing the field: on the left of the screen, high, before the keeper
    left_hand, right_foot, nose = to_panda(
        np.array([[0.5, 2.0, 0.0], [-0.2, 0.1, 0.0], [0.0, 1.6, 0.2]])
    )
    assert left_hand.tolist() == [-0.5, 0.0, 2.0]
    assert right_foot.tolist() == [0.2, 0.0, 0.1]
    assert nose.tolist() == [0.0, 0.2, 1.6]


def test_words_follow_the_match() -> None:
    match = Match(MatchRules(), AimedShooter(AT_HAND))
    match.tick(None)
    start = hud_text(match, "", OK, "", None).table
    assert "Stand three big steps from your cameras" in start, "before anybody is seen"
    absent = hud_text(match, "", StreamState("no mocapd there"), "", None)
    assert absent.table.endswith("no mocapd there")
    match.tick(t_pose())
    assert "Stretch both arms" in hud_text(match, "", OK, "", None).message
    play(match, t_pose(), 0.7)
    assert hud_text(match, "", OK, "", None).big == "3"
    match = playing(AT_HAND)
    text = hud_text(match, "60 Hz", OK, "SAVED", None)
    assert (text.clock, text.score, text.streak, text.popup) == ("2:00", "0", "0 : 0", "SAVED")
    play(match, None, 1.0)
    text = hud_text(match, "", OK, "", None)
    assert (match.phase, text.big) == (Phase.PAUSED, "PAUSE")
    assert "tracking lost" in text.message


def test_the_end_of_a_round_says_how_it_went_and_who_is_best() -> None:
    match = playing(AT_HAND)
    match.score = Score(points=960, saves=6, goals=2, streak=0, best_streak=4)
    match.phase = Phase.OVER
    best = (HighScore(2140, 12, 3, 7, "2026-01-01", "Noor"), HighScore(960, 6, 2, 4, "2026-01-02"))
    settings = PlayerSettings(name="Kim", types=True)
    table = hud_text(match, "", OK, "", Placed(best, 1), settings).table
    for told in ("960 points", "6 saves   2 goals   75 % kept out", "longest streak 4"):
        assert told in table
    assert "1.  2140  Noor  12:3" in table
    assert "2.  960  Kim  6:2  2026-01-02  (you)" in table
    assert "Your name: Kim_" in table


def test_difficulty_goes_round_and_is_the_level_of_the_next_shots() -> None:
    names = ["easy"]
    for _ in range(3):
        names.append(next_difficulty(names[-1]))
    assert names == ["easy", "normal", "hard", "easy"]
    levels = [level_of(name) for name in names[:3]]
    assert levels == sorted(levels)
    match = playing(AT_HAND)
    match.set_level(level_of("hard"))
    assert match.difficulty.level == level_of("hard")
    match.recalibrate()
    assert match.difficulty.level == level_of("hard")


def test_a_slow_machine_is_not_blamed_on_the_player() -> None:
    slow = StreamState(slow="too slow: 95 % of the frame sets are skipped -- close other programs")
    match = playing(AT_HAND)
    assert "tracking is slow" in hud_text(match, "60 Hz", slow, "", None).foot
    play(match, None, 1.0)
    text = hud_text(match, "", slow, "", None)
    assert text.message == "tracking is slow: close other programs"


def test_a_save_is_shown_for_a_moment() -> None:
    popups = Popups()
    shot = AimedShooter(AT_HAND).next_shot(0, 0.0, None, None)  # type: ignore[arg-type]
    popups.heard([Saved(shot, Outcome(0, 12.0, np.zeros(3)), 120, 4)], 10.0)
    assert popups.text(10.5) == "SAVED  +120   4 in a row"
    assert popups.text(12.0) == ""


def test_latency_counts_each_sighting_at_its_first_picture() -> None:
    latency = Latency()
    assert latency.median_s is None
    for now_s in (10.06, 10.08, 10.10):
        latency.shown(10.0, now_s)
    assert latency.median_s == pytest.approx(0.06)


@pytest.mark.parametrize(
    "make",
    [synth.kick, synth.slap, synth.net, synth.cheer, synth.groan, synth.whistle, synth.murmur],
)
def test_sounds_are_loud_enough_end_and_do_not_clip(make: object) -> None:
    samples = make()  # type: ignore[operator]
    assert 0.1 < np.abs(samples).max() <= 1.0
    with wave.open(io.BytesIO(synth.wav(samples))) as file:
        assert file.getnframes() == len(samples)
    assert 0.1 < len(samples) / synth.RATE_HZ < 7.0


def test_pictures_are_whole_and_those_that_tile_have_no_seam() -> None:
    for picture in (pictures.grass(), pictures.crowd(0), pictures.ball(), pictures.sky()):
        assert picture.dtype == np.uint8
        assert picture.shape[2] == 4
        assert picture.flags["C_CONTIGUOUS"]
    grass = pictures.grass().astype(int)
    step = np.abs(grass[0] - grass[-1]).mean()
    assert step < 2.0 * np.abs(np.diff(grass, axis=0)).mean()


def test_the_core_needs_neither_graphics_nor_network() -> None:
    """Every module of the core, and all that plays a recording without a window."""
    code = (
        "import sys, goalkeeper.core.match, goalkeeper.core.clip, goalkeeper.app.headless\n"
        "print(sorted({'panda3d', 'direct', 'zenoh', 'cv2', 'numba'} & set(sys.modules)))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        check=True,
        env={"PYTHONPATH": ":".join(p for p in sys.path if p)},
    )
    assert done.stdout.strip() == "[]"
