"""Tasks in processes side by side: their order, their end, and what is said of the way."""

import subprocess
import sys
import time
from pathlib import Path

import psutil

from mocapd.app.daemon import task_pool
from mocapd.app.daemon.task_pool import Progress, Share, Task, run_tasks
from mocapd.errors import InputError
from tests.outputs.frames import eventually


def noting(folder: Path, name: str) -> Task:
    def work(_tell: Share) -> None:
        with (folder / "order").open("a") as out:
            out.write(name)

    return Task("all", 1.0, work)


def test_each_task_begins_when_what_it_needs_is_done_and_the_longest_way_goes_first(
    tmp_path: Path,
) -> None:
    def task(name: str, seconds: float, after: set[int]) -> Task:
        return Task("all", seconds, noting(tmp_path, name).work, frozenset(after))

    tasks = [
        task("a", 1.0, set()),
        task("b", 2.0, set()),
        task("c", 9.0, {0}),
        task("d", 1.0, {1, 2}),
    ]
    assert run_tasks(tasks, 1, lambda _: None)
    assert (tmp_path / "order").read_text() == "acbd"


def test_two_run_side_by_side(tmp_path: Path) -> None:
    """Each waits for the other."""

    def meet(mine: str, other: str) -> Task:
        def work(_tell: Share) -> None:
            (tmp_path / mine).touch()
            assert eventually((tmp_path / other).exists, 60.0)

        return Task("all", 1.0, work)

    assert run_tasks([meet("a", "b"), meet("b", "a")], 2, lambda _: None)


def test_a_task_that_fails_ends_all(tmp_path: Path) -> None:
    def fail(_tell: Share) -> None:
        raise InputError("damaged")

    tasks = [Task("all", 1.0, fail), Task("all", 1.0, noting(tmp_path, "x").work, frozenset({0}))]
    assert not run_tasks(tasks, 2, lambda _: None)
    assert not (tmp_path / "order").exists()


def test_progress_is_by_expected_seconds_and_what_a_long_task_tells() -> None:
    told: list[Progress] = []

    def half(tell: Share) -> None:
        tell(0.5)
        time.sleep(0.6)

    tasks = [
        Task("compiling", 3.0, lambda _: None),
        Task("compiling", 1.0, lambda _: time.sleep(0.6), frozenset({0})),
        Task("film", 1.0, half, frozenset({0, 1}), reports=True),
    ]
    assert run_tasks(tasks, 1, told.append)
    shares = [(one.shares["compiling"], one.shares["film"]) for one in told]
    assert shares == sorted(shares)
    assert any(0.75 <= compiling < 1.0 and film == 0.0 for compiling, film in shares)
    assert (1.0, 0.5) in shares
    assert shares[-1] == (1.0, 1.0)
    assert told[-1].left_s == 0.0


def test_what_is_left_is_no_shorter_than_what_must_follow_one_another() -> None:
    told: list[Progress] = []
    tasks = [
        Task("all", 1.0, lambda _: time.sleep(0.5)),
        Task("all", 9.0, lambda _: None, frozenset({0})),
    ]
    assert run_tasks(tasks, 2, told.append)
    assert told[0].left_s > 7.0  # 5 s, if both processes could share it


def test_later_tasks_are_expected_to_be_slowed_by_the_stream() -> None:
    left_s = []
    for is_later in (False, True):
        tasks = [Task("all", 9.0, lambda _: None, is_later=is_later)]
        left_s.append(task_pool._progress([], task_pool._State(tasks, 1.0), [9.0], 1).left_s)
    assert left_s[1] > 1.1 * left_s[0] > 0.0


def test_the_processes_end_with_who_began_them(tmp_path: Path) -> None:
    program = (
        "import os, time\n"
        "from mocapd.app.daemon.task_pool import Task, run_tasks\n"
        "def work(_):\n"
        "    os.write(1, b'%d\\n' % os.getpid())\n"
        "    time.sleep(600)\n"
        "run_tasks([Task('all', 1.0, work), Task('all', 1.0, work)], 2, lambda _: None)\n"
    )
    with subprocess.Popen(
        [sys.executable, "-c", program], stdout=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        children = [int(process.stdout.readline()) for _ in range(2)]
        process.kill()
        assert eventually(lambda: not any(psutil.pid_exists(pid) for pid in children), 60.0)
