"""Folders of ours are ours alone; what others could have put there is not believed."""

import os
from pathlib import Path

import pytest

from mocapd.boundary.folders import private_folder, readable_by_others, require_own_folder
from mocapd.errors import PermissionDeniedError


def mode(path: Path) -> int:
    return path.stat().st_mode & 0o7777


def test_a_folder_is_made_for_us_alone_and_a_wider_one_is_narrowed(tmp_path: Path) -> None:
    private_folder(tmp_path / "new")
    (tmp_path / "old").mkdir(mode=0o755)
    private_folder(tmp_path / "old")
    assert (mode(tmp_path / "new"), mode(tmp_path / "old")) == (0o700, 0o700)
    assert readable_by_others(Path("/"))
    assert not readable_by_others(tmp_path / "old")
    assert not readable_by_others(tmp_path / "none")


def test_what_everybody_uses_and_a_home_are_left_as_they_are(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "shared").mkdir()
    (tmp_path / "shared").chmod(0o1777)
    (tmp_path / "home").mkdir(mode=0o755)
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    for name in ("shared", "home"):
        before = mode(tmp_path / name)
        private_folder(tmp_path / name)
        assert mode(tmp_path / name) == before


def test_a_folder_of_ours_is_believed(tmp_path: Path) -> None:
    for wanted in (0o700, 0o755):
        tmp_path.chmod(wanted)
        require_own_folder(tmp_path)


@pytest.mark.parametrize("wider", [0o777, 0o1777, 0o702])
def test_a_folder_that_others_may_write_is_refused(tmp_path: Path, wider: int) -> None:
    tmp_path.chmod(wider)
    with pytest.raises(PermissionDeniedError, match="written by others") as caught:
        require_own_folder(tmp_path)
    assert str(tmp_path) in str(caught.value)
    assert "chmod 700" in caught.value.fix


def test_a_folder_in_which_others_can_put_another_in_its_place_is_refused(tmp_path: Path) -> None:
    (tmp_path / "shared" / "cache").mkdir(parents=True)
    (tmp_path / "link").symlink_to(tmp_path / "shared" / "cache")
    (tmp_path / "shared").chmod(0o777)
    for path in (tmp_path / "shared" / "cache", tmp_path / "link"):
        with pytest.raises(PermissionDeniedError, match="every user can replace it"):
            require_own_folder(path)
    (tmp_path / "shared").chmod(0o1777)  # as /tmp is
    require_own_folder(tmp_path / "shared" / "cache")


@pytest.mark.skipif(os.geteuid() != 0, reason="only root can give a folder away")
def test_a_folder_of_somebody_else_is_refused(tmp_path: Path) -> None:
    (tmp_path / "theirs").mkdir()
    os.chown(tmp_path / "theirs", 54321, 54321)
    with pytest.raises(PermissionDeniedError, match="belongs to uid 54321"):
        require_own_folder(tmp_path / "theirs")
