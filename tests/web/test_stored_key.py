"""A key that cannot be kept is told with the mend that fits."""

import errno
import os
from pathlib import Path

import pytest

from mocapd.errors import CannotCreateError, mend_of
from mocapd.web import stored_key


@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EDQUOT])
def test_on_a_full_disk_room_is_the_mend(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, number: int
) -> None:
    def full(*_args: object, **_kwargs: object) -> None:
        raise OSError(number, os.strerror(number))

    monkeypatch.setattr(stored_key, "whole_file", full)
    with pytest.raises(CannotCreateError) as caught:
        stored_key.stored_key(tmp_path / "metrics.key")
    assert caught.value.fix == "make room on that disk"
    assert os.strerror(number) in caught.value.what


def test_of_a_missing_right_it_is_not() -> None:
    error = PermissionError(errno.EACCES, os.strerror(errno.EACCES))
    assert mend_of(error, "let this user write there") == "let this user write there"
