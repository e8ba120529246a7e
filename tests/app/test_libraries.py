"""The cache folder: what lies there is run, so it must be ours."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

import mocapd
from mocapd.app.libraries import use_cache_dir
from mocapd.errors import CannotCreateError, PermissionDeniedError


@pytest.fixture(autouse=True)
def read_only_package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The package as it is installed for all users: numba keeps its code in the cache folder."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", "")  # so that it is put back: the code sets it
    monkeypatch.delenv("NUMBA_CACHE_DIR")
    monkeypatch.setattr(mocapd, "__file__", str(tmp_path / "no such package" / "__init__.py"))


def test_the_cache_is_made_for_us_alone(tmp_path: Path) -> None:
    use_cache_dir(tmp_path / "new" / "cache")
    for path in (tmp_path / "new" / "cache", tmp_path / "new" / "cache" / "numba"):
        assert path.stat().st_mode & 0o777 == 0o700
    assert os.environ["NUMBA_CACHE_DIR"] == str(tmp_path / "new" / "cache" / "numba")


@pytest.mark.parametrize("shared", ["cache", "cache/numba"])
def test_a_cache_that_others_may_write_is_refused(tmp_path: Path, shared: str) -> None:
    """A pickle planted there ran as the user."""
    (tmp_path / "cache" / "numba").mkdir(parents=True)
    (tmp_path / shared).chmod(0o777)
    with pytest.raises(PermissionDeniedError, match="written by others") as caught:
        use_cache_dir(tmp_path / "cache")
    assert str(tmp_path / shared) in caught.value.where
    assert "cache_dir" in caught.value.fix
    assert "NUMBA_CACHE_DIR" not in os.environ


def test_the_working_directory_does_not_say_where_code_is_kept(
    tmp_path: Path, clean_env: dict[str, str]
) -> None:
    """numba reads its settings from there where PyYAML is installed: another user's folder may hold another user's code."""
    (tmp_path / "yaml.py").write_text("def safe_load(file): return {'cache_dir': file.read()}")
    (tmp_path / ".numba_config.yaml").write_text("/elsewhere")
    code = f"""
import os; os.chdir({str(tmp_path)!r})
from mocapd.app.libraries import use_cache_dir
from pathlib import Path
use_cache_dir(Path({str(tmp_path / "cache")!r}))
from numba.core import config
print(config._HAVE_YAML, repr(config.CACHE_DIR))
"""
    env = clean_env | {"PYTHONPATH": str(tmp_path)}
    told = run_code(code, env)[0]
    assert told.startswith("True")
    assert "/elsewhere" not in told


def test_a_path_that_cannot_be_is_named(tmp_path: Path) -> None:
    with pytest.raises(CannotCreateError, match="cannot be written"):
        use_cache_dir(tmp_path / ("x" * 300))


@pytest.mark.parametrize(
    "read",
    [
        "from mocapd.cli.options import effective_config as of; of(None, None, capture='sim:living_room')",
        "import mocapd.cli.run",
        "import mocapd.app.terminal.status_text",
    ],
    ids=["configuration", "run", "status"],
)
def test_no_kernel_is_imported_before_it_is_known_where_its_code_is_kept(
    read: str, clean_env: dict[str, str]
) -> None:
    """It would be compiled anew, beside what was prepared."""
    told = run_code(f"import sys; {read}; print('numba' in sys.modules)", clean_env)
    assert told == ("False\n", "")


def test_the_kernels_own_places_are_known_to_numba_whatever_imports_it(
    clean_env: dict[str, str],
) -> None:
    code = (
        "import mocapd.body.posing_kernels as kernels; print(kernels.retract._cache._impl.locator)"
    )
    assert "KernelLocator" in run_code(code, clean_env)[0]


def run_code(code: str, env: dict[str, str]) -> tuple[str, str]:
    """What it prints in a process of its own, to both streams."""
    done = subprocess.run(
        [sys.executable, "-c", code], env=env, capture_output=True, text=True, check=False
    )
    return done.stdout, done.stderr
