"""Imports in a running service wait for idle moments of its pipeline."""

import importlib
import sys
import threading
from pathlib import Path

import pytest

from mocapd.app.daemon import patient_imports
from mocapd.app.daemon.patient_imports import PatientImports
from mocapd.pipeline.idle_moments import IdleMoments


class CountingIdle(IdleMoments):
    """Every moment is idle."""

    waits = 0

    def wait(self, timeout_s: float = 0.0) -> None:
        """Counts."""
        self.waits += 1


@pytest.fixture
def modules(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> tuple[str, ...]:
    """Names of modules that nothing has imported yet."""
    monkeypatch.syspath_prepend(str(tmp_path))
    names = tuple(f"patiently_{i}" for i in range(4))
    for name in names:
        (tmp_path / f"{name}.py").write_text("")
        monkeypatch.delitem(sys.modules, name, raising=False)
    return names


def test_a_new_module_waits_for_an_idle_moment_unless_the_last_one_lasts(
    modules: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    before = list(sys.meta_path)
    for piece_s, waits in ((-1.0, 2), (3600.0, 1)):
        monkeypatch.setattr(patient_imports, "_PIECE_S", piece_s)
        idle = CountingIdle()
        with PatientImports(idle):
            for name in (*modules[:2], modules[0]):
                importlib.import_module(name)
        assert idle.waits == waits
        for name in modules:
            sys.modules.pop(name, None)
    assert sys.meta_path == before


def test_imports_of_other_threads_do_not_wait(modules: tuple[str, ...]) -> None:
    idle = CountingIdle()
    with PatientImports(idle):
        other = threading.Thread(target=importlib.import_module, args=(modules[0],))
        other.start()
        other.join()
    assert modules[0] in sys.modules
    assert idle.waits == 0
