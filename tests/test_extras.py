"""The base runs the daemon, its page, `calibrate`, `watch` and `doctor`; a command of an extra names it where it lacks."""

import subprocess
import sys
from importlib import metadata
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from mocapd import extras
from mocapd.cli.board import board
from mocapd.cli.eval import Joints, evaluate_captures
from mocapd.cli.shirt import shirt
from mocapd.errors import MissingExtraError
from mocapd.extras import EXTRAS, install_command

# Imports every module of the package in a process that finds the given packages only, and prints those that fail.
_IMPORT_ALL = """
import importlib, importlib.abc, pkgutil, sys

hidden = set(sys.argv[1:])

class Hide(importlib.abc.MetaPathFinder):
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in hidden:
            raise ModuleNotFoundError(f"{name} is of an extra", name=name)
        return None

sys.meta_path.insert(0, Hide())
import mocapd.capture.environment
for found in pkgutil.walk_packages(mocapd.__path__, "mocapd."):
    try:
        importlib.import_module(found.name)
    except ModuleNotFoundError as error:
        print(found.name, error.name)
"""


def _base() -> set[str]:
    """The packages that an installation without extras brings."""
    found: set[str] = set()
    wanted = ["mocapd"]
    while wanted:
        name = canonicalize_name(wanted.pop())
        if name not in found:
            found.add(name)
            for text in metadata.requires(name) or ():
                requirement = Requirement(text)
                if requirement.marker is None or requirement.marker.evaluate({"extra": ""}):
                    wanted.append(requirement.name)
    return found


def test_all_but_printing_and_plots_runs_on_the_base() -> None:
    base = _base()
    hidden = {
        module
        for module, packages in metadata.packages_distributions().items()
        if not base & {canonicalize_name(name) for name in packages}
    }
    assert hidden >= set(EXTRAS.values())
    command = [sys.executable, "-c", _IMPORT_ALL, *sorted(hidden)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    failed = dict(line.split() for line in done.stdout.splitlines())
    assert {name.partition(".")[0] for name in failed.values()} == {"reportlab", "matplotlib"}
    assert set(failed) <= {
        "mocapd.evaluate.plots",
        *(f"mocapd.printing.{name}" for name in ("pdf_document", "board_pdf", "shirt_pdf")),
        *(f"mocapd.printing.{name}" for name in ("shirt_drawing", "shirt_tiles")),
    }


def test_a_command_without_its_extra_names_it_before_it_begins(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    for library in EXTRAS.values():
        monkeypatch.setitem(sys.modules, library, None)
    out = tmp_path / "out"
    with pytest.raises(MissingExtraError, match=r"mocapd board: .*mocapd\[print\].* reportlab$"):
        board(out)
    with pytest.raises(MissingExtraError, match=r"mocapd shirt: .*mocapd\[print\].* reportlab$"):
        shirt(out)
    with pytest.raises(MissingExtraError, match=r"mocapd eval --out: .*mocapd\[plots\]"):
        evaluate_captures([tmp_path], joints=Joints.UPPER, out=out)
    assert not out.exists()


def test_the_library_is_added_by_what_made_the_environment(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    prefix = tmp_path / "my venvs" / "mocapd"
    prefix.mkdir(parents=True)
    monkeypatch.setattr(sys, "prefix", str(prefix))
    monkeypatch.setattr(sys, "executable", str(prefix / "bin/python"))
    python = f"'{prefix}/bin/python'"
    assert install_command("print") == f"{python} -m pip install reportlab"
    monkeypatch.setattr(extras, "find_spec", lambda _name: None)
    assert install_command("print") == f"uv pip install --python {python} reportlab"
    monkeypatch.setattr(extras, "find_spec", lambda name: name == "uv" or None)
    assert install_command("print") == f"{python} -m uv pip install --python {python} reportlab"
    (prefix / "pipx_metadata.json").touch()
    assert install_command("print") == "pipx inject mocapd reportlab"
