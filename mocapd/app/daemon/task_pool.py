"""Long work that is made of many parts, some after others, in a few processes side by side; with true progress."""

import multiprocessing
import os
import signal
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess

from mocapd.child_process import end_with_parent
from mocapd.errors import MocapdError

Share = Callable[[float], None]  # hears how much of a task is done, 0..1

_TELL_S = 0.25
_LATER_NICE = 10
_TRUSTED_S = 3.0  # of work, after which the measured pace counts as much as the one that was given


@dataclass(frozen=True, slots=True)
class Task:
    """`seconds`: how long it takes on the machine that the figures are of; `after`: indices of earlier tasks of the list;
    `is_later`: not among what is waited for first; `tells`: it says how much of it is done."""

    what: str
    seconds: float
    work: Callable[[Share], object]
    after: frozenset[int] = frozenset()
    is_later: bool = False
    tells: bool = False


@dataclass(frozen=True, slots=True)
class Progress:
    """Shares 0..1 of the work of each kind (`Task.what`), by expected seconds; left_s: by the pace so far."""

    shares: dict[str, float]
    left_s: float


@dataclass(slots=True)
class _Worker:
    process: BaseProcess
    pipe: Connection
    task: int = -1
    began_s: float = 0.0
    told: float = 0.0


@dataclass(slots=True)
class _State:
    tasks: Sequence[Task]
    first_pace: float
    done: set[int] = field(default_factory=set)
    taken: set[int] = field(default_factory=set)
    spent_s: float = 0.0  # by the clock, of those that are done
    expected_s: float = 0.0  # likewise, by their own figures


def run_tasks(
    tasks: Sequence[Task],
    processes: int,
    tell: Callable[[Progress], None],
    pace: float = 1.0,
    on_first: Callable[[], None] = lambda: None,
) -> bool:
    """Whether all came to a good end; ends at the first that did not.

    Of the tasks that may begin, those that are not `is_later` go first, and of these the one with the longest way behind
    it; on_first: called when none but later ones are left, which then run with little priority. The processes are forks, so
    what the tasks need is best imported before; they end with this one. Call it while the process has one thread.
    pace: how much longer than in `Task.seconds` this machine takes, as far as that is known beforehand.
    """
    fork = multiprocessing.get_context("fork")
    way_s, state, workers = _ways(tasks), _State(tasks, pace), []
    try:
        for _ in range(min(processes, len(tasks))):
            here, there = fork.Pipe()
            child = fork.Process(target=_work, args=(there, tasks))
            child.start()
            there.close()
            workers.append(_Worker(child, here))
        first = {i for i, task in enumerate(tasks) if not task.is_later}
        while len(state.done) < len(tasks):
            if first and first <= state.done:
                first = set()
                on_first()
            for worker in workers:
                _give(worker, state, way_s)
            for pipe in wait([worker.pipe for worker in workers if worker.task >= 0], _TELL_S):
                worker = next(one for one in workers if one.pipe is pipe)
                if not _hear(worker, state):
                    return False
            tell(_progress(workers, state, processes))
        return True
    finally:
        for worker in workers:
            worker.process.kill()
            worker.process.join()


def _ways(tasks: Sequence[Task]) -> list[float]:
    """Seconds from the beginning of each task to the end of the longest chain of tasks that follow it."""
    way_s = [task.seconds for task in tasks]
    for i in range(len(tasks) - 1, -1, -1):
        for before in tasks[i].after:
            way_s[before] = max(way_s[before], tasks[before].seconds + way_s[i])
    return way_s


def _give(worker: _Worker, state: _State, way_s: Sequence[float]) -> None:
    free = [
        i for i, task in enumerate(state.tasks) if i not in state.taken and task.after <= state.done
    ]
    if worker.task >= 0 or not free:
        return
    worker.task = max(free, key=lambda i: (not state.tasks[i].is_later, way_s[i]))
    worker.began_s, worker.told = time.monotonic(), 0.0
    state.taken.add(worker.task)
    worker.pipe.send(worker.task)


def _hear(worker: _Worker, state: _State) -> bool:
    """Whether what it says is good."""
    try:
        said = worker.pipe.recv()
    except EOFError:
        return False
    if isinstance(said, float):
        worker.told = said
    else:
        state.done.add(worker.task)
        state.spent_s += time.monotonic() - worker.began_s
        state.expected_s += state.tasks[worker.task].seconds
        worker.task = -1
    return True


def _progress(workers: Sequence[_Worker], state: _State, processes: int) -> Progress:
    # what was known beforehand counts like the first seconds of work
    pace = (state.spent_s + _TRUSTED_S * state.first_pace) / (state.expected_s + _TRUSTED_S)
    done_s: dict[str, float] = {}
    all_s: dict[str, float] = {}
    for i, task in enumerate(state.tasks):
        all_s[task.what] = all_s.get(task.what, 0.0) + task.seconds
        done_s[task.what] = done_s.get(task.what, 0.0) + task.seconds * (i in state.done)
    for worker in workers:
        if worker.task >= 0:
            task = state.tasks[worker.task]
            guess = min((time.monotonic() - worker.began_s) / max(pace * task.seconds, 1e-3), 0.9)
            done_s[task.what] += task.seconds * (worker.told if task.tells else guess)
    left_s = pace * (sum(all_s.values()) - sum(done_s.values())) / max(1, processes)
    return Progress({what: done_s[what] / max(all_s[what], 1e-9) for what in all_s}, left_s)


def _work(pipe: Connection, tasks: Sequence[Task]) -> None:
    parent = multiprocessing.parent_process()
    assert parent is not None
    assert parent.pid is not None
    end_with_parent(parent.pid, signal.SIGKILL)
    for number in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP):
        signal.signal(number, signal.SIG_DFL)
    try:
        niced = False
        while True:
            task = tasks[pipe.recv()]
            if task.is_later and not niced:
                os.nice(_LATER_NICE)
                niced = True
            task.work(pipe.send)
            pipe.send(None)
    except (EOFError, MocapdError):
        os._exit(1)
