"""What stands before a background: people, not their shadows, not the light, not what somebody uncovered."""

import numpy as np
import pytest

from mocapd.vision.foreground_kernels import (
    BACKGROUND,
    BEFORE,
    CLOTH_OR_SHADOW,
    SHADOW,
    UNKNOWN,
    stands_before,
)
from mocapd.vision.room_background import BackgroundParams, RoomBackground

H, W = 60, 80
SURE, LIKELY = (0.5, 7.0), (0.25, 12.0)
NOBODY = np.zeros((H, W), np.uint8)


def wall(seed: int = 0) -> np.ndarray:
    """A coloured wall with texture, and noise from picture to picture."""
    rng = np.random.default_rng(3)
    texture = rng.normal(0.0, 6.0, (H // 4, W // 4, 1)).repeat(4, 0).repeat(4, 1)
    noise = np.random.default_rng(seed).normal(0.0, 1.5, (H, W, 3))
    return np.clip(np.array([110.0, 130.0, 160.0]) + texture + noise, 0, 255).astype(np.uint8)


def learned(looks: int = 20) -> RoomBackground:
    background = RoomBackground(H, W, BackgroundParams())
    for seed in range(looks):
        background.learn(wall(seed), NOBODY)
    return background


def naive(pixel: np.ndarray, mean: np.ndarray) -> int:
    """`stands_before` of one known pixel, by its definition."""
    a, m = pixel.astype(float), mean.astype(float)
    if np.abs(a - m).max() <= 16.0:
        return BACKGROUND
    share = float(a @ m / (m @ m + 1.0))
    off = float(np.abs(a - share * m).max())
    if share < 1.0 and share > SURE[0] and off < SURE[1]:
        return SHADOW
    if LIKELY[0] <= share < 1.0 and off < LIKELY[1]:
        return CLOTH_OR_SHADOW
    return BEFORE


def test_the_kernel_does_what_its_definition_says() -> None:
    rng = np.random.default_rng(1)
    mean = rng.uniform(5.0, 250.0, (40, 50, 3)).astype(np.float32)
    share = rng.uniform(0.1, 1.3, (40, 50, 1))
    picture = np.clip(share * mean + rng.normal(0.0, 5.0, mean.shape), 0, 255).astype(np.uint8)
    age = np.where(rng.random((40, 50)) < 0.1, 2, 9).astype(np.uint8)
    out = np.empty((40, 50), np.uint8)
    stands_before(picture, mean, age, 0, 0, 6, 16.0, SURE, LIKELY, out)
    assert (out[age < 6] == UNKNOWN).all()
    told = {int(k) for k in np.unique(out)}
    assert told == {BACKGROUND, BEFORE, UNKNOWN, SHADOW, CLOTH_OR_SHADOW}
    for y, x in zip(*np.nonzero(age >= 6), strict=True):
        assert out[y, x] == naive(picture[y, x], mean[y, x])


def test_a_part_of_the_picture_is_told_as_the_whole_of_it() -> None:
    """But for its edge, where specks and gaps are told by what lies beyond."""
    background, picture = learned(), wall(99)
    picture[10:40, 20:35] = (40, 200, 90)
    picture[45:58, 20:60] = (0.65 * picture[45:58, 20:60]).astype(np.uint8)
    whole = background.foreground(picture)
    part = background.foreground(picture, (14, 6, 55, 52))
    assert (part[11:47, 19:50] == whole[11:47, 19:50]).all()
    assert {BEFORE, SHADOW, BACKGROUND} <= set(np.unique(part[11:47, 19:50]).tolist())
    outside = np.ones((H, W), bool)
    outside[6:52, 14:55] = False
    assert not part[outside].any()
    assert not background.foreground(picture, (0, 0, 0, 0)).any()


def test_the_foreground_is_exactly_where_it_stands() -> None:
    """A mask that is off by a pixel turns a body that cameras see from all sides by ten degrees."""
    background, picture = learned(), wall(99)
    body = np.zeros((H, W), bool)
    body[12:41, 20:35] = True
    picture[body] = (40, 200, 90)
    np.testing.assert_array_equal(background.foreground(picture) == BEFORE, body)


def test_specks_are_noise_gaps_are_somebody_and_what_is_not_known_stays_so() -> None:
    background = learned()
    hidden = np.zeros((H, W), np.uint8)
    hidden[30:40, 60:70] = 1
    new = RoomBackground(H, W, BackgroundParams())
    for seed in range(20):
        new.learn(wall(seed), hidden)
    picture = wall(99)
    picture[10:40, 20:35] = (40, 200, 90)
    picture[25, 20:35] = wall(99)[25, 20:35]
    picture[50, 10] = (40, 200, 90)
    before = background.foreground(picture)
    assert (before[25, 22:33] == BEFORE).all()
    assert before[50, 10] == BACKGROUND
    assert (new.foreground(picture)[31:39, 61:69] == UNKNOWN).all()


def test_somebody_stands_before_it_and_a_shadow_does_not() -> None:
    picture = wall(99)
    picture[10:40, 20:35] = (40, 200, 90)
    picture[45:58, 20:60] = (0.65 * picture[45:58, 20:60]).astype(np.uint8)
    before = learned().foreground(picture)
    assert (before[12:38, 22:33] == BEFORE).all()
    assert np.mean(before[46:57, 21:59] == SHADOW) > 0.95
    assert not before[:8].any()


def test_nothing_is_known_before_it_was_seen() -> None:
    background = learned(3)
    assert background.is_new
    assert (background.foreground(wall(5)) == UNKNOWN).all()


def test_a_lamp_that_goes_out_is_followed_also_behind_somebody() -> None:
    background = learned()
    body = NOBODY.copy()
    body[20:40, 30:50] = 1
    dark = (0.45 * wall(50)).astype(np.uint8)
    seen = dark.copy()
    seen[20:40, 30:50] = (20, 90, 40)
    gain = background.follow_light(seen, body)
    assert gain is not None
    assert gain == pytest.approx(0.45, abs=0.03)
    assert np.mean(background.foreground(dark) == BACKGROUND) > 0.95
    assert background.follow_light(dark, NOBODY) is None


def test_somebody_whom_nobody_tracks_does_not_become_the_room_when_a_lamp_goes_out() -> None:
    """And the rest of the room stays known."""
    background = learned()
    seen = (0.45 * wall(50)).astype(np.uint8)
    seen[15:50, 30:50] = (20, 90, 140)
    assert background.follow_light(seen, NOBODY) is not None
    before = background.foreground(seen)
    assert (before[17:48, 32:48] == BEFORE).all()
    assert np.mean(before[:, :28] == BACKGROUND) > 0.98
    assert background.follow_light(seen, NOBODY) is None


@pytest.mark.parametrize("somebody_is_tracked", [False, True])
def test_somebody_who_passes_close_to_the_lens_is_no_lamp(somebody_is_tracked: bool) -> None:
    background, body = learned(), NOBODY.copy()
    if somebody_is_tracked:
        body[20:50, 10:20] = 1
    seen = wall(50)
    seen[20:50, 10:20] = (20, 90, 140)
    seen[:, 50:] = np.random.default_rng(3).integers(60, 120, (H, W - 50, 3))
    assert background.follow_light(seen, body) is None
    assert np.mean(background.foreground(seen)[:, 52:] != BACKGROUND) > 0.95
    gone = wall(51)
    gone[20:50, 10:20] = (20, 90, 140)
    before = background.foreground(gone)
    assert (before[22:48, 12:18] == BEFORE).all()
    assert np.mean(before[:, 40:] == BACKGROUND) > 0.98


def test_after_something_dark_before_the_lens_the_room_is_as_it_was() -> None:
    """Somebody who came meanwhile stands before it."""
    background = learned(80)
    dark = wall(90)
    dark[:, 30:] = 8
    assert background.follow_light(dark, NOBODY) is not None
    background.learn(dark, NOBODY)
    darker = wall(91)
    darker[:, 15:] = 8
    background.follow_light(darker, NOBODY)
    seen = wall(92)
    seen[20:50, 60:65] = (20, 90, 140)
    assert background.follow_light(seen, NOBODY) is not None
    before = background.foreground(seen)
    assert (before[22:48, 61:64] == BEFORE).all()
    assert np.mean(before[:, :55] == BACKGROUND) > 0.98


def test_what_somebody_uncovers_is_background_and_somebody_who_comes_is_not() -> None:
    """A person who stood there while the background was learned, and goes."""
    background = RoomBackground(H, W, BackgroundParams())
    for seed in range(20):
        occupied = wall(seed)
        occupied[10:50, 10:22] = (30, 60, 200)
        background.learn(occupied, NOBODY)
    now = wall(70)
    now[10:50, 50:62] = (200, 60, 30)
    before = background.foreground(now)
    assert (before[12:48, 12:20] > 0).all()
    background.remove_ghosts(now, before, NOBODY, NOBODY)
    assert not before[:, :30].any()
    assert (before[12:48, 52:60] == BEFORE).all()
    assert not background.foreground(wall(71))[:, :30].any()


def test_what_was_uncovered_beside_somebody_is_no_arm_though_one_was_fitted_to_it() -> None:
    """A passer-by was learned with the room, and left a ghost that touches the wearer, whose arm is drawn into it."""
    background = RoomBackground(H, W, BackgroundParams())
    for seed in range(20):
        occupied = wall(seed)
        occupied[6:50, 14:32] = (30, 60, 200)
        background.learn(occupied, NOBODY)
    now, body, arms = wall(70), NOBODY.copy(), NOBODY.copy()
    now[8:56, 32:44] = (200, 60, 30)
    body[8:56, 32:44] = 1
    arms[10:34, 26:32] = 1
    body |= arms
    before = background.foreground(now)
    assert (before[12:48, 16:30] > 0).all()
    background.remove_ghosts(now, before, body, arms)
    assert not before[:, :31].any()
    assert (before[10:54, 34:42] == BEFORE).all()


def test_an_arm_before_the_wall_is_not_taken_for_it() -> None:
    background, now, body, arms = learned(), wall(70), NOBODY.copy(), NOBODY.copy()
    now[8:56, 32:44] = (200, 60, 30)
    now[12:18, 4:32] = (200, 60, 30)
    body[8:56, 32:44] = 1
    arms[12:18, 8:32] = 1
    body |= arms
    before = background.foreground(now)
    background.remove_ghosts(now, before, body, arms)
    assert (before[13:17, 6:30] == BEFORE).all()


def test_a_region_alone_is_looked_at_as_the_whole_is() -> None:
    background, picture = learned(), wall(99)
    picture[10:40, 20:35] = (40, 200, 90)
    whole, part = (
        background.foreground(picture).copy(),
        background.foreground(picture, (10, 4, 60, 50)),
    )
    assert (part[6:48, 12:58] == whole[6:48, 12:58]).all()
    assert not part[52:].any()
    assert not background.foreground(picture, (0, 0, 0, 0)).any()


def test_the_room_beside_somebody_who_never_left_is_learned_when_it_stays_the_same() -> None:
    background, known = RoomBackground(H, W, BackgroundParams()), BackgroundParams().least_looks
    somebody = np.zeros((H, W), np.uint8)
    somebody[10:50, 30:50] = 1
    background.seed(wall(), somebody)
    inner = np.zeros((H - 20, 30), np.uint8)  # what is drawn of them now, within a region
    inner[:, 10:20] = 1
    for seed in range(known):
        picture = wall(seed)
        if seed % 2:
            picture[10:20, 27:37] = 250  # somebody's hand, now and then
        background.learn_unknown(picture, inner, (25, 10, 55, 50))
    before = background.foreground(wall(known))
    assert (before[20:50, 30:35] == BACKGROUND).all()
    assert (before[20:50, 45:50] == BACKGROUND).all()
    assert (before[20:50, 35:45] == UNKNOWN).all()  # they stood there all the time
    assert (before[12:18, 30:35] == UNKNOWN).all()


def test_what_is_known_is_not_learned_so_near_to_somebody() -> None:
    background = learned()
    for _ in range(30):
        background.learn_unknown(np.full((H, W, 3), 250, np.uint8), NOBODY, (0, 0, W, H))
    assert (background.foreground(np.full((H, W, 3), 250, np.uint8)) == BEFORE).all()


@pytest.mark.parametrize("ticks", [2, 4])
def test_fewer_pictures_a_second_teach_the_background_as_fast(ticks: int) -> None:
    """A wall that was painted, at 30 Hz and at a half or a quarter of that."""
    quick, slow = learned(), learned()
    painted = np.full((H, W, 3), 140, np.uint8)
    for tick in range(40):
        quick.learn(painted, NOBODY)
        if tick % ticks == ticks - 1:
            slow.learn(painted, NOBODY, ticks)
    np.testing.assert_array_equal(slow.mean, quick.mean)
    assert np.abs(quick.mean - learned().mean).max() > 5.0


@pytest.mark.parametrize(("ticks", "pictures"), [(1, 20), (2, 10), (3, 7), (30, 7)])
def test_it_is_known_after_two_thirds_of_a_second_at_any_rate(ticks: int, pictures: int) -> None:
    """At 15 Hz it was new for 1.3 s: who was in view by then became part of it."""
    background = RoomBackground(H, W, BackgroundParams())
    for seed in range(pictures):
        assert background.is_new
        background.learn(wall(seed), NOBODY, ticks)
    assert not background.is_new
    assert (background.foreground(wall(99)) == BACKGROUND).all()
