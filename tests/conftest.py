"""What every test shares: quiet libraries, an environment of its own, and the recordings in ../shared."""

import gc
import os

# Before numpy loads: thread pools cost more than they bring at these sizes.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("OMP_NUM_THREADS", "1")

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
import tomli_w
from hypothesis import settings

import mocapd.kernels  # noqa: F401 -- before numba, which some tests import by themselves

if TYPE_CHECKING:  # numba takes a second to import, and most tests need none of it
    from mocapd.shirt.pose_database.database import PoseDatabase

gc.set_threshold(20_000)  # as `mocapd` does: compiling kernels takes a fifteenth less

ROOT = Path(__file__).resolve().parents[1]
SHARED = ROOT.parent / "shared"
ABSENT = "../shared is not beside this checkout: {} is missing"

# No example is judged by how long it took: this machine may be busy.
settings.register_profile("mocapd", deadline=None, derandomize=True, print_blob=True)
settings.load_profile("mocapd")


@pytest.fixture(scope="session")
def shared_dir() -> Path:
    """../shared: the recordings and tools beside the checkout; skips where it is absent."""
    if not SHARED.is_dir():
        pytest.skip(ABSENT.format("the folder"))
    return SHARED


@pytest.fixture(scope="session")
def dev_captures(shared_dir: Path) -> Callable[[str], Path]:
    """The folder of a development capture by its name, `dev_captures("pair_office_traffic")`."""

    def folder(name: str) -> Path:
        path = shared_dir / "captures" / "dev" / name
        if not (path / "rig.json").is_file():
            pytest.skip(ABSENT.format(f"captures/dev/{name}"))
        return path

    return folder


@pytest.fixture(scope="session")
def cache_home(pytestconfig: pytest.Config) -> Path:
    """Where child processes keep the pose database and films, so that they are made once."""
    assert pytestconfig.cache is not None
    return pytestconfig.cache.mkdir("mocapd")


@pytest.fixture(scope="session")
def pose_database(cache_home: Path) -> "PoseDatabase":
    """A small pose database, built once."""
    return kept_database(cache_home, count=3000, cells=32)


@pytest.fixture(scope="session")
def smaller_database(cache_home: Path) -> "PoseDatabase":
    """One of a third of the poses, for pictures that need no more."""
    return kept_database(cache_home, count=1000, cells=16)


def kept_database(cache_home: Path, **params: Any) -> "PoseDatabase":
    """The pose database of these DatabaseParams, read as a daemon reads its own; the first who needs it makes it."""
    from mocapd.shirt.pose_database.database import DatabaseParams, content_hash
    from mocapd.shirt.pose_database.database_file import load_or_build

    wanted = DatabaseParams(**params)
    folder = cache_home / "databases" / content_hash(wanted)[:16]
    folder.mkdir(parents=True, exist_ok=True)
    return load_or_build(folder, wanted).database


@pytest.fixture
def clean_env(tmp_path: Path, cache_home: Path) -> dict[str, str]:
    """The environment of a user with an empty home and no MOCAPD_* variable, for child processes.

    What is made once and kept is that user's already, apart from the first who needs it.
    """
    return environment(tmp_path, cache_home)


def environment(folder: Path, cache_home: Path) -> dict[str, str]:
    """See `clean_env`; the home is made in `folder`."""
    dropped = (
        "MOCAPD_", "XDG_", "JOURNAL_STREAM", "STATE_DIRECTORY", "CACHE_DIRECTORY", "PYTHONDONTWRITEBYTECODE",
        "NUMBA_",
    )  # fmt: skip
    env = {k: v for k, v in os.environ.items() if not k.startswith(dropped)}
    home = folder / "home"
    home.mkdir()
    env |= {"HOME": str(home), "XDG_CACHE_HOME": str(cache_home)}
    return env | {"NO_COLOR": "1", "COLUMNS": "100", "PYTHONPATH": str(ROOT)}


@pytest.fixture
def empty_home(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    """This process as that of a user with an empty home, which is returned, and no MOCAPD_* variable."""
    for name in (*os.environ,):
        if name.startswith(("MOCAPD_", "RUNTIME_DIRECTORY", "STATE_DIRECTORY", "CACHE_DIRECTORY")):
            monkeypatch.delenv(name)
    for kind in ("cache", "config", "state", "runtime"):
        folder = tmp_path / kind
        folder.mkdir(mode=0o700)
        name = "XDG_RUNTIME_DIR" if kind == "runtime" else f"XDG_{kind.upper()}_HOME"
        monkeypatch.setenv(name, str(folder))
    return tmp_path


@pytest.fixture(scope="session")
def simulated(tmp_path_factory: pytest.TempPathFactory) -> str:
    """A scenario of small pictures, as `--capture` takes it; its film is made once for all tests."""
    from tests.sim import small

    scenario = tmp_path_factory.mktemp("scenario") / "small.toml"
    scenario.write_text(tomli_w.dumps(small.table()))
    return f"sim:{scenario}"


class _SkippedForNothing:
    """With MOCAPD_REQUIRE_SHARED set (.ci/run), a test skipped for want of ../shared fails the run."""

    def __init__(self) -> None:
        self.skipped: list[str] = []

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        # longrepr of a skip: file, line, reason
        if report.skipped and isinstance(report.longrepr, tuple) and "shared" in report.longrepr[2]:
            self.skipped.append(report.nodeid)

    @pytest.hookimpl(tryfirst=True)
    def pytest_sessionfinish(self, session: pytest.Session) -> None:
        if self.skipped:
            session.exitstatus = pytest.ExitCode.TESTS_FAILED

    def pytest_terminal_summary(self, terminalreporter: pytest.TerminalReporter) -> None:
        for test in self.skipped:
            terminalreporter.write_line(f"FAILED: ../shared is there, yet skipped: {test}")


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_collection() -> Iterator[None]:
    """What is imported and collected stays to the end: the garbage collector need not look through it, neither
    now nor in the tests."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.collect()
        gc.freeze()
        gc.enable()


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """In a process that shares the tests with others (`make test`), what takes long comes first, and what
    needs many kernels last: another process has compiled them by then."""
    if hasattr(config, "workerinput"):
        items.sort(
            key=lambda item: (
                item.get_closest_marker("long") is None,
                item.get_closest_marker("kernels") is not None,
            )
        )


def pytest_configure(config: pytest.Config) -> None:
    if os.environ.get("MOCAPD_REQUIRE_SHARED"):
        config.pluginmanager.register(_SkippedForNothing())
