"""Files that somebody else named are regular and of bounded size, or refused at once."""

import io
import os
from pathlib import Path
from typing import Any

import pytest

from mocapd.boundary import files
from mocapd.errors import ConfigError, InputError


def test_a_regular_file_is_read(tmp_path: Path) -> None:
    path = tmp_path / "a"
    path.write_bytes(b"\x00\xff")
    assert files.read_file(path, 2) == b"\x00\xff"


def test_a_pipe_without_a_writer_is_not_waited_for(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(InputError, match="no regular file"):
        files.read_file(tmp_path / "pipe", 10)


@pytest.mark.parametrize("path", ["/dev/zero", "/dev/null", "/", "a\0b", "x" * 5000])
def test_what_is_no_regular_file_is_refused(path: str) -> None:
    with pytest.raises(InputError):
        files.read_file(Path(path), 10)


def test_a_regular_file_that_has_nothing_to_read_yet_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As /proc/kmsg and files of FUSE are: a read that does not wait returns None."""

    class Waiting(io.FileIO):
        def read(self, size: int | None = -1, /) -> bytes | None:  # type: ignore[override]
            return None

    path = tmp_path / "kmsg"
    path.touch()
    monkeypatch.setattr("os.fdopen", Waiting)
    with pytest.raises(InputError, match="nothing to read"):
        files.read_file(path, 10)


def test_a_file_that_is_too_large_is_refused(tmp_path: Path) -> None:
    with (tmp_path / "large").open("wb") as file:
        file.truncate(1 << 40)  # takes no room on the disk
    with pytest.raises(InputError, match="larger than"):
        files.read_file(tmp_path / "large", 1000)


def test_of_a_large_file_only_the_beginning_is_read(tmp_path: Path) -> None:
    with (tmp_path / "large").open("wb") as file:
        file.write(b"head")
        file.truncate(1 << 40)
    assert files.read_beginning(tmp_path / "large", 6) == b"head\0\0"
    (tmp_path / "small").write_bytes(b"he")
    assert files.read_beginning(tmp_path / "small", 6) == b"he"


def test_a_missing_file_has_its_own_name(tmp_path: Path) -> None:
    with pytest.raises(files.MissingError, match="no such file"):
        files.read_file(tmp_path / "none", 10)


def test_a_link_that_leads_to_nothing_is_not_missing(tmp_path: Path) -> None:
    (tmp_path / "link").symlink_to(tmp_path / "share" / "file")
    with pytest.raises(InputError, match="leads to nothing") as caught:
        files.read_file(tmp_path / "link", 10)
    assert not isinstance(caught.value, files.MissingError)


def test_a_file_that_is_written_the_moment_it_is_looked_for_is_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It was taken for a link that leads to nothing, and put into quarantine."""
    path, look = tmp_path / "file", os.open

    def too_early(*args: Any) -> int:
        monkeypatch.setattr(os, "open", look)
        path.write_bytes(b"here")
        raise FileNotFoundError

    monkeypatch.setattr(os, "open", too_early)
    assert files.read_file(path, 10) == b"here"


def test_absent_is_only_what_the_system_says_is_not_there(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    (tmp_path / "link").symlink_to(tmp_path / "nothing")
    (tmp_path / "loop").symlink_to(tmp_path / "loop")
    assert files.is_absent(tmp_path / "none")
    assert files.is_absent(tmp_path / "none" / "below")
    assert files.is_absent(tmp_path / "file" / "below")
    for there in ("file", "link", "link/below", "loop", "loop/below", "x" * 5000, "a\0b"):
        assert not files.is_absent(tmp_path / there)


def test_what_lies_in_a_folder_that_may_not_be_entered_is_not_absent(tmp_path: Path) -> None:
    folder = tmp_path / "closed"
    folder.mkdir(mode=0o000)
    child = os.fork()
    if child == 0:
        if os.geteuid() == 0:  # whom nothing is closed to
            tmp_path.parent.parent.chmod(0o711)
            tmp_path.parent.chmod(0o711)
            tmp_path.chmod(0o711)
            os.setuid(65534)
        os._exit(files.is_absent(folder / "config.toml"))
    assert os.waitpid(child, 0)[1] == 0


def test_text_that_is_no_utf8_is_refused(tmp_path: Path) -> None:
    (tmp_path / "a").write_bytes(b"\xff")
    with pytest.raises(InputError, match=r"no UTF-8 text .* -- save it as UTF-8"):
        files.read_text(tmp_path / "a", 10)


def test_the_byte_order_mark_of_an_editor_is_no_part_of_a_text(tmp_path: Path) -> None:
    (tmp_path / "a").write_bytes(b"\xef\xbb\xbfport = 1\n")
    assert files.read_text(tmp_path / "a", 20) == "port = 1\n"


def test_the_home_of_nobody_is_refused() -> None:
    with pytest.raises(ConfigError, match="no such user"):
        files.user_path("~nosuchuser/x")


@pytest.mark.parametrize("path", ["x" * 5000, "a\0b"])
def test_what_can_be_no_path_is_not_there(path: str) -> None:
    assert not files.is_file(Path(path))
    assert not files.is_folder(Path(path))


def test_a_nul_in_a_path_is_refused_where_it_is_written() -> None:
    with pytest.raises(ConfigError, match="is no path"):
        files.user_path("a\0b")
