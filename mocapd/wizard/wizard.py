"""The wizard: the present step, its thread, and its view for the page."""

import logging
import queue
import threading
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path

from mocapd.boundary.numbers import brief
from mocapd.capture.camera_thread.capture_status import CaptureStatus
from mocapd.clock import monotonic_ns
from mocapd.errors import InputError, Problem
from mocapd.pipeline.frame_hub import FrameHub
from mocapd.wizard.commands import OF_WIZARD, Again, BeginAnew, Go, Next, Resume, Wear, read_command
from mocapd.wizard.context import Context, Step
from mocapd.wizard.draft import Draft
from mocapd.wizard.numeric_trouble import EXPECTED, name_trouble
from mocapd.wizard.setup_keeper import SetupKeeper, UnfinishedSetup
from mocapd.wizard.step import Json, Scene, StepState, T, Tell
from mocapd.wizard.step_job import StepJob
from mocapd.wizard.step_names import StepName, after_shirt, steps_done, steps_wanted
from mocapd.wizard.wizard_view import WizardView, with_offer

_TICK_S = 0.05
_MOST_COMMANDS = 32  # in the queue, of up to 8 MB each; a person never gets there

_log = logging.getLogger(__name__)

_TOO_MANY = Problem("too many commands at once", "the page", "wait until it answers")

MakeStep = Callable[[Context], Step]


class Wizard:
    """Runs one step at a time in a thread of its own, from `start` to `stop`; the Context of its steps.

    `view`, `send` and `picture` may be called from any thread. `died` gets an unexpected exception that ended the
    thread.
    """

    def __init__(
        self,
        hub: FrameHub,
        steps: Mapping[StepName, MakeStep],
        statuses: Callable[[], Mapping[str, CaptureStatus]],
        state_dir: Path,
        cache_dir: Path,
        died: Callable[[BaseException], None],
        scene: Callable[[Scene], object] | None = None,
        first: StepName = StepName.CAMERAS,
        draft: Draft | None = None,
        on_saved: Callable[[], None] | None = None,
        keeper: SetupKeeper | None = None,
    ) -> None:
        self.hub, self.state_dir, self.cache_dir = hub, state_dir, cache_dir
        self.draft = draft if draft is not None else Draft()
        self._steps, self._statuses, self._died = steps, statuses, died
        self._scene, self._on_saved = scene, on_saved
        self._keeper = keeper
        self._all = tuple(name for name in StepName if name in steps)
        self._commands: queue.Queue[tuple[str, Mapping[str, Json]]] = queue.Queue(_MOST_COMMANDS)
        self._flooded = threading.Event()  # the queue refused a command
        self._stopping = threading.Event()
        self._job = StepJob()
        self._reached: set[StepName] = set()  # steps done since the start
        if self.draft.rig is not None:  # an earlier setup, of which the user repeats some steps
            self._reached |= set(StepName)
        self._saved = False  # since the start
        self._refused: Problem | None = None
        self._stumbled = ""  # the last tick's error
        self._step: Step = steps[first](self)
        self._changed = threading.Condition()  # guards the view
        self._view = self._snapshot(0)
        self._thread = threading.Thread(target=self._run, name="wizard", daemon=True)

    # -- from any thread -------------------------------------------------------------------------

    def start(self) -> None:
        """Begin; returns at once."""
        self._thread.start()

    def stop(self, timeout_s: float = 1.0) -> bool:
        """End; False when the thread or its job is still busy after `timeout_s` [s]."""
        self._stopping.set()
        if self._thread.ident is not None:
            self._thread.join(timeout_s)
        return not self._thread.is_alive()

    def send(self, verb: str, args: Mapping[str, Json] | None = None) -> None:
        """Take a command of the page: one of `commands.OF_WIZARD`, or of the step's own."""
        try:
            self._commands.put_nowait((verb, args or {}))
        except queue.Full:
            self._flooded.set()

    def view(self) -> WizardView:
        """The newest snapshot."""
        with self._changed:
            return self._view

    def newer(self, serial: int, timeout_s: float) -> WizardView:
        """The snapshot as soon as it is newer than `serial`, or after `timeout_s` [s]."""
        with self._changed:
            self._changed.wait_for(lambda: self._view.serial > serial, timeout_s)
            return self._view

    def picture(self, key: str) -> bytes | None:
        """A picture that the newest view names; None for another one."""
        return self.view().view.pictures.get(key)

    # -- Context, for the steps ------------------------------------------------------------------

    def statuses(self) -> Mapping[str, CaptureStatus]:
        return self._statuses()

    def scene(self, scene: Scene) -> None:
        if self._scene is not None:
            self._scene(scene)

    def start_job(self, job: Callable[[Tell], T], done: Callable[[T], None]) -> None:
        self._job.start(job, done)

    def on_saved(self) -> None:
        self._saved = True
        if self._keeper is not None:
            self._keeper.on_saved(self.draft)
        if self._on_saved is not None:
            self._on_saved()

    @property
    def job(self) -> tuple[str, float] | None:
        return self._job.progress

    # -- the wizard's thread ---------------------------------------------------------------------

    def _run(self) -> None:
        try:
            self._step.enter()
            while not self._stopping.is_set():
                self._look_after_job()
                self._tick()
                self._publish()
                self._take_commands()
            self._step.leave()
            self._publish()  # the end
            if self._keeper is not None:
                self._keeper.close()
        except BaseException as error:
            self._died(error)
            raise
        finally:
            self._job.close()  # here, as a last tick may start one

    def _look_after_job(self) -> None:
        try:
            self._job.finish()
        except EXPECTED as error:
            self._step.job_failed(name_trouble(error, self._step.name))

    def _tick(self) -> None:
        """Shows an error like a refusal, and tries again with the next tick."""
        try:
            self._step.tick(monotonic_ns())
            self._stumbled = ""
        except EXPECTED as error:
            trouble = name_trouble(error, self._step.name)
            if str(trouble) != self._stumbled:  # not twenty times a second
                self._stumbled = str(trouble)
                _log.warning("%s", trouble)
            self._refused = Problem.of(trouble)

    def _take_commands(self) -> None:
        """Waits a tick for the first; takes all in the queue."""
        timeout_s: float | None = _TICK_S
        while True:
            try:
                verb, args = self._commands.get(timeout=timeout_s)
            except queue.Empty:
                return
            timeout_s = 0.0
            self._refused = self._refusal_of(verb, args)
            if self._commands.empty() and self._flooded.is_set():
                self._flooded.clear()
                self._refused = _TOO_MANY
            self._publish()

    def _refusal_of(self, verb: str, args: Mapping[str, Json]) -> Problem | None:
        """Execute a command; returns why it was refused, or None."""
        try:
            self._take(verb, args)
        except EXPECTED as error:
            return Problem.of(name_trouble(error, self._step.name))
        # Arguments were checked, so this is a bug. It must not cost a setup of a quarter of an hour: the command's
        # effect is doubtful, earlier results are not.
        except (ArithmeticError, LookupError, TypeError, ValueError) as error:
            _log.exception("a bug in mocapd: the command %r of the step %s", verb, self._step.name)
            return Problem(
                f"this went wrong inside mocapd ({type(error).__name__})",
                self._step.name,
                "press “Start again”, and report what mocapd has logged",
            )
        return None

    def _take(self, verb: str, args: Mapping[str, Json]) -> None:
        """Raises MocapdError when it is refused."""
        verbs = {**self._step.verbs, **OF_WIZARD}
        command = read_command(verbs, verb, args, self._step.name)
        if self._offer is not None and isinstance(command, Go | Next | Wear):
            raise InputError(
                "there is an unfinished setup",
                "this setup",
                "say below whether to go on with it, or begin anew",
            )
        match command:
            case Go(step=name):
                names = {name.value: name for name in self._names}
                if name not in names:
                    raise InputError(f"no step {brief(name)}", "the page", "reload the page")
                self._show(names[name])
            case Next():
                if self._step.view().state is not StepState.DONE:
                    raise InputError(
                        "this step is not done yet", self._step.name, "finish it first"
                    )
                at = self._names.index(self._step.name)
                if at + 1 < len(self._names):
                    self._show(self._names[at + 1])
            case Again():
                self._show(self._step.name)
            case Wear(shirt=shirt):
                self._wear(shirt)
            case Resume():
                self._resume()
            case BeginAnew():
                self._require_keeper().discard()
            case _:
                self._step.command(command)

    @property
    def _offer(self) -> UnfinishedSetup | None:
        return self._keeper.offer if self._keeper is not None else None

    @property
    def _names(self) -> tuple[StepName, ...]:
        return steps_wanted(self._all, self.draft)

    def _wear(self, shirt: bool) -> None:
        """Results with a shirt stay, should it turn up."""
        if shirt == self.draft.has_shirt:
            return
        self.draft = replace(self.draft, has_shirt=shirt)
        after = after_shirt(self._step.name, self._names, self.draft)
        if after is not None:
            self._show(after)

    def _resume(self) -> None:
        """Go on with the first unfinished step. Raises InputError without an unfinished setup."""
        unfinished = self._require_keeper().resume()
        self.draft = unfinished.draft
        self._reached |= unfinished.done
        left = [name for name in self._names if not self._is_done(name)]
        self._show(left[0] if left else self._names[-1])

    def _require_keeper(self) -> SetupKeeper:
        if self._keeper is None:
            raise InputError("there is no unfinished setup", "this setup", "reload the page")
        return self._keeper

    def _show(self, name: StepName) -> None:
        step = self._steps[name](self)  # raises where its inputs are missing: then this one stays
        self._step.leave()
        self._job.forget()
        self._step = step
        self._step.enter()

    def _is_done(self, name: StepName) -> bool:
        """Whether its result is in the draft, and was reached since the start."""
        return name in self._reached and name in steps_done(self.draft, self._saved)

    def _snapshot(self, serial: int) -> WizardView:
        view = self._step.view()
        if view.state is StepState.DONE:
            self._reached.add(self._step.name)
        if self._offer is not None:
            view = with_offer(view, self._offer)
        return WizardView(
            serial,
            self._step.name,
            frozenset(name for name in self._names if self._is_done(name)),
            view,
            self._refused,
            self._saved,
            self._stopping.is_set(),
            self._names,
            self.draft.has_shirt,
        )

    def _publish(self) -> None:
        with self._changed:
            self._view = self._snapshot(self._view.serial + 1)
            self._changed.notify_all()
        if self._keeper is not None:
            self._keeper.keep(self.draft, self._view.done)
