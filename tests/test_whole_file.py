"""A file is written whole or not at all."""

import os
import subprocess
from pathlib import Path

import pytest

from mocapd.whole_file import tidy, whole_file


def test_the_new_takes_the_place_of_the_old_and_nothing_else_is_left(tmp_path: Path) -> None:
    path = tmp_path / "kept.json"
    path.write_text("old")
    with whole_file(path) as partial:
        partial.write_text("new")
        assert path.read_text() == "old"
        assert partial.suffix == ".json"
    assert path.read_text() == "new"
    assert list(tmp_path.iterdir()) == [path]


def test_a_failure_leaves_the_old_file_as_it_was(tmp_path: Path) -> None:
    path = tmp_path / "kept.json"
    path.write_text("old")
    with pytest.raises(UnicodeEncodeError), whole_file(path) as partial:
        _write_half(partial)
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def _write_half(path: Path) -> None:
    path.write_bytes(b"half")
    path.write_text("\udcff", encoding="utf-8")


def test_two_that_write_at_once_do_not_mix(tmp_path: Path) -> None:
    path = tmp_path / "kept"
    with whole_file(path) as first, whole_file(path) as second:
        first.write_text("first")
        second.write_text("second")
    assert path.read_text() == "first"  # the one that ended last
    assert list(tmp_path.iterdir()) == [path]


def test_a_folder_that_is_not_there_is_an_os_error(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError), whole_file(tmp_path / "none" / "file") as partial:
        partial.write_text("")


def test_others_may_read_it_as_any_new_file(tmp_path: Path) -> None:
    (tmp_path / "usual").touch()
    with whole_file(tmp_path / "kept") as partial:
        partial.touch()
    assert (tmp_path / "kept").stat().st_mode == (tmp_path / "usual").stat().st_mode


def test_a_private_file_is_never_readable_by_others(tmp_path: Path) -> None:
    path = tmp_path / "kept"
    path.write_text("of an earlier version")
    path.chmod(0o644)
    with whole_file(path, private=True) as partial:
        assert partial.stat().st_mode & 0o777 == 0o600
        partial.write_text("new")
    assert path.stat().st_mode & 0o777 == 0o600
    assert path.read_text() == "new"


def dead_pid() -> int:
    done = subprocess.Popen(["true"])
    done.wait()
    return done.pid


def test_what_a_killed_process_left_half_written_goes(tmp_path: Path) -> None:
    """4 of 20 kills during a save left up to 0.9 MB, with the wearer's picture, for ever."""
    path = tmp_path / "cam0-0123456789ab.png"
    left = tmp_path / f".cam0-0123456789ab.{dead_pid()}.a1b2c3.png"
    other = tmp_path / f".cam1-0123456789ab.{dead_pid()}.a1b2c3.png"
    under_way = tmp_path / f".cam0-0123456789ab.{os.getppid()}.a1b2c3.png"
    forgotten = tmp_path / f".cam0-0123456789ab.{os.getppid()}.d4e5f6.png"
    for one in (left, other, under_way, forgotten, tmp_path / ".hidden.png"):
        one.write_bytes(b"half")
    os.utime(forgotten, (1e9, 1e9))
    with whole_file(path) as partial:
        partial.write_bytes(b"whole")
    assert set(tmp_path.iterdir()) == {path, other, under_way, tmp_path / ".hidden.png"}
    tidy(tmp_path, path.stat().st_mtime)
    assert set(tmp_path.iterdir()) == {path, under_way, tmp_path / ".hidden.png"}
