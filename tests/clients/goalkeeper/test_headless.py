"""A recorded session without a window: the same score again, and bad files said in one line."""

from pathlib import Path

import pytest

from goalkeeper.app.main import main
from tests.clients.goalkeeper.session import session_frames, without_left_hand, write_session

SECONDS = 30.0


@pytest.fixture(scope="module")
def session(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Half a minute, in which the player is lost for two seconds and his left hand for one."""
    frames = session_frames(SECONDS, lost_s=(15.0, 17.0))
    frames[300:330] = [without_left_hand(frame) for frame in frames[300:330]]
    return write_session(tmp_path_factory.mktemp("session") / "session.mcap", frames)


def _headless(session: Path, *more: str) -> int:
    return main(["--headless", "--recording", str(session), *more])


def test_the_same_input_gives_the_same_score(
    session: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    texts = []
    for seed in ("3", "3", "4"):
        assert _headless(session, "--seed", seed) == 0
        texts.append(capsys.readouterr().out)
    assert texts[0] == texts[1] != texts[2]
    assert "the player was lost 1 times" in texts[0]
    last = texts[0].splitlines()[-1]
    shots = len(texts[0].splitlines()) - 2
    saves, goals = int(last.split()[2]), int(last.split()[4])
    assert saves + goals == shots > 5


@pytest.mark.parametrize(("difficulty", "levels"), [("easy", "03 13"), ("hard", "48 58")])
def test_the_difficulty_is_that_of_the_option(
    session: Path, capsys: pytest.CaptureFixture[str], difficulty: str, levels: str
) -> None:
    """By the level after one shot, a goal or a save."""
    assert _headless(session, "--difficulty", difficulty, "--shots", "1") == 0
    last = capsys.readouterr().out.splitlines()[-1]
    assert any(f"level 0.{level} after" in last for level in levels.split())


def test_a_session_that_stops_in_the_middle_is_scored_until_there(
    session: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(session.read_bytes()[: session.stat().st_size // 2])
    assert _headless(cut, "--shots", "50") == 0
    assert "score" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"", "is no MCAP file"),
        (b"RIFF....WAVEfmt ", "is no MCAP file"),
        (None, "no such recording"),
    ],
)
def test_what_is_no_recording_is_said(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], content: bytes | None, said: str
) -> None:
    path = tmp_path / "other.mcap"
    if content is not None:
        path.write_bytes(content)
    assert _headless(path) == 66
    assert said in capsys.readouterr().err


def test_a_person_who_is_not_in_it_is_said(
    session: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert _headless(session, "--person", "7") == 66
    assert "no frame of person 7" in capsys.readouterr().err
