"""Runs a graph of tasks in a few parallel processes, and estimates the progress."""

import gc
import os
import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack, suppress
from dataclasses import dataclass, field
from multiprocessing import Pipe
from multiprocessing.connection import Connection, wait

from mocapd.app.daemon.forked_child import forked

Share = Callable[[float], None]  # reports the done share of a task, 0..1

_REPORT_S = 0.25
_LATER_NICE = 10
_TRUSTED_S = 3.0  # of work, after which measured and given pace have equal weight
_LATER_PACE = 1.5  # of later tasks, relative to the others: a stream runs beside them
_SPIN_S = 0.25  # in which the processes find out how much of a processor each gets


@dataclass(frozen=True, slots=True)
class Task:
    """`seconds`: duration on the reference machine; `after`: indices of prerequisite tasks, earlier in the list; `is_later`:
    low priority, not needed for the start; `reports`: it reports its progress."""

    what: str
    seconds: float
    work: Callable[[Share], object]
    after: frozenset[int] = frozenset()
    is_later: bool = False
    reports: bool = False


@dataclass(frozen=True, slots=True)
class Progress:
    """Done shares 0..1 of each kind of work (`Task.what`), by expected seconds; left_s: remaining time [s]; pace: time of
    this machine, as busy as it is, relative to `Task.seconds`."""

    shares: dict[str, float]
    left_s: float
    pace: float


@dataclass(slots=True)
class _Worker:
    pipe: Connection
    task: int = -1
    began_s: float = 0.0
    share: float = 0.0


@dataclass(slots=True)
class _State:
    tasks: Sequence[Task]
    first_pace: float
    done: set[int] = field(default_factory=set)
    taken: set[int] = field(default_factory=set)
    # elapsed and expected time of the finished tasks, by is_later
    spent_s: dict[bool, float] = field(default_factory=lambda: {False: 0.0, True: 0.0})
    expected_s: dict[bool, float] = field(default_factory=lambda: {False: 0.0, True: 0.0})

    def pace(self, is_later: bool) -> float:
        """Time of this machine relative to `Task.seconds`: as measured, and as expected with the weight of _TRUSTED_S."""
        expected = _LATER_PACE * self.pace(False) if is_later else self.first_pace
        return (self.spent_s[is_later] + _TRUSTED_S * expected) / (
            self.expected_s[is_later] + _TRUSTED_S
        )


def run_tasks(
    tasks: Sequence[Task],
    processes: int,
    report: Callable[[Progress], None],
    pace: float = 1.0,
    on_first: Callable[[], None] = lambda: None,
) -> bool:
    """Runs all tasks; False at the first failure.

    List scheduling by critical path: of the runnable tasks those that are not `is_later` go first, then the one with the
    longest remaining chain. on_first: called when only later tasks remain, which run at low priority. The processes are
    forks: import the tasks' modules before. They end with this process. Call it while the process has one thread.
    pace: initial estimate of this machine's processor time relative to `Task.seconds`; by the clock it takes longer where
    other programs are busy or a quota holds, which the processes measure first.
    """
    way_s, workers = _ways(tasks), list[_Worker]()
    with ExitStack() as children:
        for _ in range(min(processes, len(tasks))):
            here, there = Pipe()
            children.enter_context(forked(_work, there, tasks))
            there.close()
            workers.append(_Worker(here))
        try:
            received = [float(worker.pipe.recv()) for worker in workers]
        except EOFError:
            return False
        state = _State(tasks, pace * len(received) / max(sum(received), 1e-3))
        first = {i for i, task in enumerate(tasks) if not task.is_later}
        while len(state.done) < len(tasks):
            if first and first <= state.done:
                first = set()
                on_first()
            for worker in workers:
                _give(worker, state, way_s)
            for pipe in wait([worker.pipe for worker in workers if worker.task >= 0], _REPORT_S):
                worker = next(w for w in workers if w.pipe is pipe)
                if not _receive(worker, state):
                    return False
            report(_progress(workers, state, way_s, processes))
        return True


def _ways(tasks: Sequence[Task]) -> list[float]:
    """Critical path: seconds from the start of each task to the end of its longest chain of successors."""
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
    worker.began_s, worker.share = time.monotonic(), 0.0
    state.taken.add(worker.task)
    worker.pipe.send(worker.task)


def _receive(worker: _Worker, state: _State) -> bool:
    """Receives a message; False after a failure."""
    try:
        message = worker.pipe.recv()
    except EOFError:
        return False
    if isinstance(message, float):
        worker.share = message
    else:
        state.done.add(worker.task)
        task = state.tasks[worker.task]
        state.spent_s[task.is_later] += time.monotonic() - worker.began_s
        state.expected_s[task.is_later] += task.seconds
        worker.task = -1
    return True


def _progress(
    workers: Sequence[_Worker], state: _State, way_s: Sequence[float], processes: int
) -> Progress:
    paces = {is_later: state.pace(is_later) for is_later in (False, True)}
    share = [float(i in state.done) for i in range(len(state.tasks))]
    for worker in workers:
        if worker.task >= 0:
            task, elapsed_s = state.tasks[worker.task], time.monotonic() - worker.began_s
            guess = min(elapsed_s / max(paces[task.is_later] * task.seconds, 1e-3), 0.9)
            share[worker.task] = worker.share if task.reports else guess
    done_s: dict[str, float] = {}
    all_s: dict[str, float] = {}
    work_s = chain_s = 0.0
    for task, done, chain in zip(state.tasks, share, way_s, strict=True):
        all_s[task.what] = all_s.get(task.what, 0.0) + task.seconds
        done_s[task.what] = done_s.get(task.what, 0.0) + task.seconds * done
        if done < 1.0:
            pace = paces[task.is_later]
            work_s += pace * task.seconds * (1.0 - done)
            chain_s = max(chain_s, pace * (chain - task.seconds * done))
    left_s = max(work_s / max(1, processes), chain_s)
    return Progress(
        {what: done_s[what] / max(all_s[what], 1e-9) for what in all_s}, left_s, paces[False]
    )


def _processor_share() -> float:
    """Share of a processor that this process gets, 0..1, measured for a moment."""
    began_s, began_cpu_s = time.monotonic(), time.process_time()
    while (passed_s := time.monotonic() - began_s) < _SPIN_S:
        pass
    return min(1.0, (time.process_time() - began_cpu_s) / passed_s)


def _work(pipe: Connection, tasks: Sequence[Task]) -> None:
    # It ends within a minute or two; until then what numba leaves (some 400 MB, all processes together) is not worth
    # looking for: a tenth of all compiling.
    gc.disable()
    with suppress(EOFError):
        pipe.send(_processor_share())
        niced = False
        while True:
            task = tasks[pipe.recv()]
            if task.is_later and not niced:
                os.nice(_LATER_NICE)
                niced = True
            task.work(pipe.send)
            pipe.send(None)
