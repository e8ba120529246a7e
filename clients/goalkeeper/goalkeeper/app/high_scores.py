"""The best rounds of this user, in the XDG data directory; a file that cannot be read or written costs no round."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import msgspec
import platformdirs

from goalkeeper.core.scoring import Score
from mocapd.boundary.files import read_text
from mocapd.boundary.parsing import decode_json
from mocapd.errors import CannotCreateError, InputError, MocapdError
from mocapd.whole_file import whole_file

KEPT = 10
LONGEST_NAME = 40
_MOST_BYTES = 1 << 16
_Count = Annotated[int, msgspec.Meta(ge=0, le=10**9)]


class HighScore(msgspec.Struct, frozen=True):
    """One round: date as YYYY-MM-DD; name: the player's, empty where none was typed."""

    points: _Count
    saves: _Count
    goals: _Count
    best_streak: _Count
    date: Annotated[str, msgspec.Meta(pattern=r"^\d{4}-\d{2}-\d{2}$")]
    name: Annotated[str, msgspec.Meta(max_length=LONGEST_NAME)] = ""


class _File(msgspec.Struct, frozen=True):
    scores: list[HighScore]


@dataclass(frozen=True, slots=True)
class Placed:
    """The table after a round; place: that of the round in it, None: not among them; trouble: one line or empty."""

    scores: tuple[HighScore, ...]
    place: int | None
    trouble: str = ""


def high_score_path() -> Path:
    """Where they are kept."""
    return platformdirs.user_data_path("mocapd-goalkeeper") / "high_scores.json"


def read_high_scores(path: Path) -> tuple[HighScore, ...]:
    """Best first; none where there is no file. Raises InputError for one that is damaged."""
    if not path.exists():
        return ()
    try:
        found = decode_json(read_text(path, _MOST_BYTES).encode(), _File)
    except InputError as error:
        raise InputError(
            f"is no table of high scores ({error.what})", str(path), "move it away"
        ) from None
    return tuple(sorted(found.scores, key=lambda one: -one.points)[:KEPT])


def with_round(scores: tuple[HighScore, ...], score: Score, date: str, name: str = "") -> Placed:
    """The table with a round in it; a round without points is in none."""
    new = HighScore(score.points, score.saves, score.goals, score.best_streak, date, name)
    place = sum(one.points >= new.points for one in scores)
    if new.points == 0 or place >= KEPT:
        return Placed(scores, None)
    return Placed((*scores[:place], new, *scores[place:])[:KEPT], place)


def keep_name(path: Path, placed: Placed, name: str) -> Placed:
    """The same table with another name in its new row, which is written where the round could be kept."""
    if placed.place is None:
        return placed
    scores = list(placed.scores)
    scores[placed.place] = msgspec.structs.replace(scores[placed.place], name=name)
    if placed.trouble:  # such as a damaged file
        return Placed(tuple(scores), placed.place, placed.trouble)
    try:
        _write(path, tuple(scores))
    except MocapdError as error:
        return Placed(tuple(scores), placed.place, str(error))
    return Placed(tuple(scores), placed.place)


def keep_round(path: Path, score: Score, date: str, name: str = "") -> Placed:
    """Read, add, write. A damaged file is left as it is, and said."""
    try:
        placed = with_round(read_high_scores(path), score, date, name)
    except InputError as error:
        alone = with_round((), score, date, name)
        return Placed(alone.scores, alone.place, str(error))
    if placed.place is None:
        return placed
    try:
        _write(path, placed.scores)
    except MocapdError as error:
        return Placed(placed.scores, placed.place, str(error))
    return placed


def _write(path: Path, scores: tuple[HighScore, ...]) -> None:
    """Raises CannotCreateError."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with whole_file(path) as partial:
            partial.write_bytes(msgspec.json.encode(_File(list(scores))))
    except OSError as error:
        raise CannotCreateError(
            f"cannot be written ({error.strerror})", str(path), "make room or check its rights"
        ) from None
