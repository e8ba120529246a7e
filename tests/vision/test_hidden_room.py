"""The room behind an adopted body is recognised when the body leaves it, and not before."""

import numpy as np

from mocapd.types import Bytes
from mocapd.vision.hidden_room import guess_room

H, W = 60, 80
BODY = np.s_[20:40, 30:44]
TOLERANCE = 16.0


def room(seed: int) -> Bytes:
    """A wall, brighter to the right, with a camera's noise."""
    noise = np.random.default_rng(seed).normal(0.0, 1.5, (H, W, 3))
    return np.asarray(np.clip(80.0 + np.arange(W)[:, None] + noise, 0, 255), np.uint8)


def with_body(seed: int, rows_down: int = 0, grey: int = 30) -> Bytes:
    picture = room(seed)
    picture[20 + rows_down : 40 + rows_down, 30:44] = grey
    return picture


def margin() -> Bytes:
    out = np.zeros((H, W), np.uint8)
    out[17:43, 27:47] = 1
    return out


def test_what_a_body_leaves_is_room_and_where_it_stays_is_not() -> None:
    hidden = guess_room(with_body(0), margin(), TOLERANCE)
    assert not hidden.is_seen(with_body(1))[BODY].any()
    moved = hidden.is_seen(with_body(2, rows_down=10))[BODY]
    assert moved[:10].all()
    assert not moved[10:].any()
    assert hidden.is_seen(room(3))[BODY].all()


def test_a_body_in_the_colours_of_the_room_has_no_holes() -> None:
    picture = with_body(0, grey=116)
    hidden = guess_room(picture, margin(), TOLERANCE)
    assert hidden.is_seen(picture)[BODY].any()
    hidden = hidden.where_hidden(picture)
    assert not hidden.is_seen(with_body(1, grey=116))[BODY].any()
