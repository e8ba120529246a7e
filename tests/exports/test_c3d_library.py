"""Without the library of the extra `export` everything but C3D works, and the command says how to get it."""

import sys
from pathlib import Path

import pytest

from mocapd.cli.recordings.export import export
from mocapd.errors import UnavailableError
from tests.exports.exported import exported


def remove_library(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "ezc3d", None)  # importing it is an ImportError


def test_without_it_the_command_names_the_extra_before_it_reads_anything(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    remove_library(monkeypatch)
    with pytest.raises(UnavailableError, match=r"--to c3d.*mocapd\[export\]") as refused:
        export(tmp_path / "none.mcap", "c3d")
    assert f"{sys.executable} -m pip install 'ezc3d>=" in refused.value.fix
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("name", ["bvh", "glb", "csv", "trc"])
def test_without_it_the_other_formats_are_written(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    remove_library(monkeypatch)
    _, path = exported(tmp_path, name)
    assert path.stat().st_size > 0
