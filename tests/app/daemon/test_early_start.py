"""A first start whose stream begins before everything is prepared."""

import multiprocessing
import time
from pathlib import Path

import pytest

from mocapd.app.daemon import cache_warmup
from mocapd.app.daemon import first_start_tasks as first_tasks
from mocapd.app.daemon.cache_warmup import Preparation
from mocapd.app.daemon.early_start import EarlyStart
from mocapd.app.daemon.first_start_tasks import begins_early, first_start_tasks
from mocapd.app.daemon.session_change import PREPARED
from mocapd.app.daemon.task_pool import Progress, Share, Task, run_tasks
from mocapd.assets import asset_path
from mocapd.config.sections import CameraSection, Config, TrackerSection
from mocapd.kernels.kernel_table import KernelRow
from mocapd.shirt.pose_database.database import DatabaseParams, PoseDatabase, content_hash
from mocapd.shirt.pose_database.database_file import write_database
from mocapd.sim.cache_file import cache_path
from mocapd.sim.film import film_key
from mocapd.sim.scenario import load_scenario
from tests.outputs.frames import eventually

SIMULATED = (
    CameraSection("cam0", "sim:living_room#cam0"),
    CameraSection("cam1", "sim:living_room#cam1"),
)
REAL = (CameraSection("left", "/dev/video0"), CameraSection("right", "/dev/video2"))


def test_the_demo_waits_for_the_shirt_and_real_cameras_for_everything(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # on a new machine, where no kernel is kept
    monkeypatch.setattr(first_tasks, "_seconds", lambda row: row.seconds)
    demo = Config(cache_dir=tmp_path, camera=SIMULATED)
    tasks = first_start_tasks(demo)
    later = {i for i, task in enumerate(tasks) if task.is_later}
    assert begins_early(demo)
    assert {tasks[i].what for i in later} == {"compiling", "pose database", "film"}
    assert all(task.is_later or not task.after & later for task in tasks)
    first_s = sum(task.seconds for task in tasks if not task.is_later)
    assert first_s < 0.7 * sum(task.seconds for task in tasks)
    for config in (
        Config(cache_dir=tmp_path, camera=REAL),
        Config(cache_dir=tmp_path, camera=SIMULATED, tracker=TrackerSection("markerless")),
    ):
        assert not begins_early(config)
        assert not any(task.is_later for task in first_start_tasks(config))


def test_what_is_there_is_not_made_again(tmp_path: Path, smaller_database: PoseDatabase) -> None:
    config, path = Config(cache_dir=tmp_path, camera=REAL), tmp_path / "pose_database.bin"
    assert any(task.what == "pose database" for task in first_start_tasks(config))
    write_database(path, smaller_database, "of another version")
    assert any(task.what == "pose database" for task in first_start_tasks(config))
    write_database(path, smaller_database, content_hash(DatabaseParams()))
    assert {task.what for task in first_start_tasks(config)} == {"compiling"}


def test_a_film_that_is_there_is_not_rendered_again(tmp_path: Path) -> None:
    """A demo after an upgrade announced a minute of it, and took seconds."""
    config = Config(cache_dir=tmp_path, camera=SIMULATED)
    assert any(task.what == "film" for task in first_start_tasks(config))
    scenario = load_scenario(asset_path("scenarios") / "living_room.toml")
    cache_path(tmp_path, "sim-living_room", film_key(scenario)).touch()
    assert not any(task.what == "film" for task in first_start_tasks(config))


def test_a_kernel_on_disk_is_expected_at_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """After a change of one kernel the demo announced seven minutes of compiling, and took five seconds."""
    monkeypatch.syspath_prepend(tmp_path)
    lines = ("import numba", "@numba.njit(cache=True)", "def twice(x):", "    return 2 * x", "")
    (tmp_path / "twice_kernels.py").write_text("\n".join(lines))
    row = KernelRow("twice_kernels", "twice", ("float64",), 5.0, frozenset({"shirt"}))
    assert first_tasks._seconds(row) == 5.0
    row.dispatcher.compile(row.arguments)
    assert first_tasks._seconds(row) < 0.1
    other = KernelRow("twice_kernels", "twice", ("int64",), 5.0, frozenset({"shirt"}))
    assert first_tasks._seconds(other) == 5.0


def test_later_tasks_come_last_and_the_first_are_told_to_be_over(tmp_path: Path) -> None:
    said = tmp_path / "said"

    def noting(name: str, is_later: bool) -> Task:
        def work(_tell: Share) -> None:
            with said.open("a") as out:
                out.write(name)

        return Task("all", 1.0 + 9.0 * is_later, work, is_later=is_later)

    tasks = [noting("later ", True), noting("first ", False)]

    def told() -> None:
        noting("told ", False).work(lambda _: None)

    assert run_tasks(tasks, 1, lambda _: None, 1.0, told)
    assert said.read_text() == "first told later "


def test_waiting_ends_when_a_stream_can_begin(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What is left goes on, and ends with the block."""

    def prepare(_config: Config, tell: cache_warmup.Report) -> None:
        tell("compiling 40 %")
        tell(cache_warmup._READY)
        tell("compiling 90 %")
        time.sleep(600.0)

    monkeypatch.setattr(cache_warmup, "prepare_in_processes", prepare)
    with cache_warmup.prepare_in_background(Config(cache_dir=tmp_path)) as preparation:
        preparation.wait()
        over = [preparation.is_over]
        assert eventually(lambda: preparation.newest() == "compiling 90 %", 60.0)
    over.append(preparation.is_over)
    assert over == [False, True]
    assert preparation.newest() == ""


def test_what_is_done_is_not_listed() -> None:
    told = [
        cache_warmup._progress_text(
            Progress({"film": share, "compiling": 1.0}, 10.0 - 10.0 * share, 1.0)
        )
        for share in (0.4, 1.0)
    ]
    assert told == [
        "once on this machine: film 40 %; about 5 s left",
        "once on this machine: done in a moment",
    ]


class Change:
    """Stands for the session's change."""

    def __init__(self) -> None:
        self.asked: list[str] = []

    def ask(self, why: str) -> None:
        self.asked.append(why)


def test_the_whole_tracker_is_asked_for_once_when_all_is_prepared() -> None:
    child = multiprocessing.get_context("fork").Process(target=time.sleep, args=(600.0,))
    child.start()
    change, told = Change(), list[str]()
    early = EarlyStart(Preparation(child), change, told.append)  # type: ignore[arg-type]
    early.on_tick(None)  # type: ignore[arg-type]
    assert change.asked == []
    assert told[-1]
    child.kill()
    child.join()
    for _ in range(3):
        early.on_tick(None)  # type: ignore[arg-type]
    assert change.asked == [PREPARED]
    assert told[-1] == ""


def test_the_whole_tracker_is_asked_for_where_the_rest_was_ready_before_the_early_session() -> None:
    """As after an upgrade, with all kernels kept."""
    change = Change()
    early = EarlyStart(Preparation(None), change, lambda _: None)  # type: ignore[arg-type]
    for _ in range(3):
        early.on_tick(None)  # type: ignore[arg-type]
    assert change.asked == [PREPARED]
