"""The tasks of a first start: compiled kernels, the film of simulated webcams, the pose database."""

import time
from functools import partial
from typing import TYPE_CHECKING

from mocapd.app.daemon.task_pool import Share, Task
from mocapd.kernels.kernel_table import KernelRow, callees_of_rows, read_table, rows_of
from mocapd.kernels.locator import KernelLocator

if TYPE_CHECKING:
    from mocapd.config.sections import Config

COMPILING, DATABASE, FILM = "compiling", "pose database", "film"
# by tracker, the stages of the table (lab/kernel_seconds.py) that it needs
_STAGES = {
    "auto": ("shirt", "clothes", "auto"),
    "shirt": ("shirt",),
    "markerless": ("clothes",),
}
_LOADING_S = 0.01  # of a kernel that is kept on disk
_LOOP = 50_000
TABLE_LOOP_S = 0.0028  # `loop_s` there
# of the whole and of its beginning, on the table's machine, without their kernels
_DATABASE_S, _DATABASE_BEGINNING_S = 20.0, 1.5
_FILM_S, _FILM_BEGINNING_S = 11.0, 3.0


def loop_s() -> float:
    """CPU time of a fixed loop [s], which compares machines."""
    return min(_timed_loop_s() for _ in range(5))


def machine_pace() -> float:
    """Time of this machine relative to the table's machine."""
    return loop_s() / TABLE_LOOP_S


def _timed_loop_s() -> float:
    began_s = time.thread_time()
    sum(i * i for i in range(_LOOP))
    return time.thread_time() - began_s


def has_tasks(tracker: str) -> bool:
    """True if the table has this tracker's kernels."""
    return tracker in _STAGES


def begins_early(config: "Config") -> bool:
    """True for an early start: simulated webcams, with the shirt only, in the first seconds of the film. With real
    cameras the setup has already compiled the tracker."""
    from mocapd.capture.kinds.source_kinds import is_simulated

    simulated = any(is_simulated(camera.source) for camera in config.camera)
    return simulated and config.tracker.name == "auto"


def first_start_tasks(config: "Config") -> list[Task]:
    """The tasks for this configuration's missing caches. Imports the kernels."""
    from mocapd.capture.kinds.source_kinds import is_made, is_simulated, origin_of
    from mocapd.shirt.pose_database.database_file import is_current
    from mocapd.trackers.registry import TRACKERS

    name, stages = config.tracker.name, list(_STAGES[config.tracker.name])
    origins = {origin_of(camera.source) for camera in config.camera if is_simulated(camera.source)}
    has_film = not all(is_made(origin, config.cache_dir) for origin in origins)
    has_database = bool(TRACKERS[name].caches) and not is_current(config.cache_dir)
    stages += ["film"] * has_film + ["database"] * has_database
    is_early = begins_early(config)
    first = {"shirt", "film", "database"} if is_early else set(stages)
    rows = rows_of(read_table(), stages)
    tasks = [
        Task(COMPILING, _seconds(row), partial(_compile, row), after, not row.stages & first)
        for row, after in zip(rows, callees_of_rows(rows), strict=True)
    ]
    making = (
        ("database", DATABASE, _DATABASE_BEGINNING_S, _DATABASE_S, _make_database),
        ("film", FILM, _FILM_BEGINNING_S, _FILM_S, _make_film),
    )
    for stage, what, beginning_s, whole_s, make in making:
        if stage not in stages:
            continue
        after = _rows_of_stage(rows, stage)
        if is_early:
            beginning = partial(make, config, is_beginning=True)
            tasks.append(Task(what, beginning_s, beginning, after, reports=True))
            after |= {len(tasks) - 1}
        tasks.append(Task(what, whole_s, partial(make, config), after, is_early, reports=True))
    return tasks


def _rows_of_stage(rows: tuple[KernelRow, ...], stage: str) -> frozenset[int]:
    return frozenset(i for i, row in enumerate(rows) if stage in row.stages)


def _seconds(row: KernelRow) -> float:
    """Expected time until the kernel is there; after a change of a few kernels most are on disk."""
    cache = row.dispatcher._cache
    if cache.cache_path is None:  # numba found no folder that it may write to
        return row.seconds
    key = cache._index_key(row.arguments, row.dispatcher.targetctx.codegen())
    return _LOADING_S if key in cache._cache_file._load_index() else row.seconds


def _compile(row: KernelRow, _report: Share) -> None:
    row.dispatcher.compile(row.arguments)
    function = row.dispatcher.py_func
    locator = KernelLocator.from_function(function, function.__code__.co_filename)
    if locator is not None:
        locator.remove_old(time.time())


def _make_database(config: "Config", report: Share, is_beginning: bool = False) -> None:
    from mocapd.session.tracker_setup import make_caches

    name, cache_dir = config.tracker.name, config.cache_dir
    make_caches(name, cache_dir, lambda _, done, of: report(done / of), is_beginning)


def _make_film(config: "Config", report: Share, is_beginning: bool = False) -> None:
    from mocapd.capture.kinds.source_kinds import open_origin, origin_of

    for origin in {origin_of(camera.source) for camera in config.camera}:
        open_origin(origin, config.cache_dir, lambda _, done, of: report(done / of), is_beginning)
