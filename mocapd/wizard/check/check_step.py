"""The step Check: tracks with the draft, judges five seconds of movement, and saves the calibration.

Its commands are `step_commands.CHECK`.
Details: phase (`missing`, `preparing`, `seeking`, `moving`, `judged`), tracking (`live`, `coasting`,
`lost`, or null), rate_hz, verdicts (see `verdict_json`), saved (the file's path; null before), next_command (see
CheckSettings), has_shirt.
"""

from collections.abc import Mapping
from dataclasses import replace
from datetime import UTC, datetime
from enum import StrEnum
from functools import partial

from mocapd.body.skeleton import INDEX, standard_skeleton
from mocapd.calibrate.verification.check_measure import Measure
from mocapd.calibrate.verification.check_verdict import (
    CameraVerdict,
    camera_verdict,
    room_problems,
    verdict_json,
)
from mocapd.clock import NS_PER_S, seconds
from mocapd.errors import InputError, MocapdError, Problem
from mocapd.pipeline.bundler import CameraCounts
from mocapd.pipeline.loop import OnDeath
from mocapd.types import Tracking
from mocapd.wizard.camera_delivery import camera_delivery
from mocapd.wizard.check.check_settings import CheckSettings
from mocapd.wizard.check.check_tracking import CheckTracker, CheckTracking, LoadTracker, prepare
from mocapd.wizard.check.missing_inputs import missing_inputs
from mocapd.wizard.commands import Command
from mocapd.wizard.context import Context
from mocapd.wizard.intrinsics.saved_intrinsics import store_intrinsics
from mocapd.wizard.newest_body import NewestBody
from mocapd.wizard.saving import calibration_of, save_draft
from mocapd.wizard.step import Scene, StepState, StepView
from mocapd.wizard.step_commands import CHECK, MeasureAgain, Save
from mocapd.wizard.step_names import StepName

MOVING_S = 5.0
# Without a shirt: time to leave the pictures; time and frame sets for learning the background, as a slow machine tracks few
LEAVE_S, LEARN_S, LEARN_SETS = 5.0, 2.0, 30
SEEK_S = 12.0  # without a person, before the reasons are shown
LEAST_MEASURES = 8  # of a verdict
LONGEST_S = 25.0  # of moving, on a busy machine
_NOBODY = Problem(
    "nobody in the shirt is found",
    "all cameras",
    "stand where the cameras see you; else do the step Colour again, in the light as it is now",
)
_NOBODY_PLAIN = Problem(
    "nobody is found",
    "all cameras",
    "leave the room empty for two seconds, come back, and stand upright where all cameras see you, facing them",
)


class Phase(StrEnum):
    MISSING = "missing"
    PREPARING = "preparing"
    LEAVING = "leaving"  # without a shirt: the wearer leaves the pictures
    EMPTY = "empty"  # the background is learned
    SEEKING = "seeking"
    MOVING = "moving"
    JUDGED = "judged"


class CheckStep:
    """See the module's docstring, and Step. `shown` gets the tracked body, for its owner to draw over each picture: at a
    tick the newest body is not the newest picture's."""

    name = StepName.CHECK
    verbs = CHECK

    def __init__(
        self,
        context: Context,
        settings: CheckSettings,
        shown: NewestBody,
        died: OnDeath,
        load: LoadTracker = prepare,
    ) -> None:
        self._context, self._settings, self._load = context, settings, load
        self._shown, self._died = shown, died
        self._tracking: CheckTracking | None = None
        self._prepared: CheckTracker | None = None  # during the wait for an empty room
        self._phase = Phase.PREPARING
        self._problems: tuple[Problem, ...] = ()
        self._measures: list[Measure] = []
        self._began_ns: int | None = None  # seeking, or moving
        self._now_ns = 0
        self._counts: Mapping[str, CameraCounts] = {}  # at the start of moving
        self._verdicts: tuple[CameraVerdict, ...] = ()
        self._saved = ""

    def enter(self) -> None:
        draft = self._context.draft
        self._context.scene(Scene.MOVING if draft.has_shirt else Scene.EMPTY)
        self._problems = tuple(missing_inputs(draft))
        if self._problems:
            self._phase = Phase.MISSING
            return
        calibration, cache_dir = calibration_of(draft), self._context.cache_dir
        self._context.start_job(
            partial(self._load, calibration, self._settings, cache_dir), self._run
        )

    def tick(self, now_ns: int) -> None:
        self._now_ns = now_ns
        if self._phase in (Phase.LEAVING, Phase.EMPTY):
            self._empty_room(now_ns)
            return
        if self._tracking is None:
            return
        fresh = self._tracking.measures()
        if self._began_ns is None:
            self._began_ns = now_ns
        elapsed_ns = now_ns - self._began_ns
        if self._phase is Phase.SEEKING:
            if self._tracking.metrics().tracking is Tracking.LIVE:
                self._move(now_ns)
            elif elapsed_ns > SEEK_S * NS_PER_S:
                self._problems = self._slowness() or (self._no_person,)
        elif self._phase is Phase.MOVING:
            self._measures += fresh
            enough = len(self._measures) >= LEAST_MEASURES
            if elapsed_ns >= MOVING_S * NS_PER_S and enough:
                self._judge()
            elif elapsed_ns > LONGEST_S * NS_PER_S:
                self._seek()
                self._problems = self._slowness() or (self._no_person,)

    def command(self, command: Command) -> None:
        match command:
            case MeasureAgain():
                if self._tracking is None or self._phase is Phase.EMPTY:
                    raise InputError("the tracker does not run yet", "check", "wait a moment")
                self._seek()
            case Save():
                self._save()

    def job_failed(self, error: MocapdError) -> None:
        self._phase, self._problems = Phase.MISSING, (Problem.of(error),)

    def view(self) -> StepView:
        state, sentence, progress = self._status()
        of_cameras = tuple(
            verdict.problem for verdict in self._verdicts if verdict.problem is not None
        )
        metrics = self._tracking.metrics() if self._tracking is not None else None
        return StepView(
            state,
            sentence,
            min(progress, 1.0),  # the empty room may take longer
            of_cameras + self._problems,
            details={
                "phase": self._phase.value,
                "tracking": None if metrics is None else metrics.tracking.value,
                "rate_hz": None if metrics is None else round(metrics.rate_hz, 1),
                "verdicts": [verdict_json(verdict) for verdict in self._verdicts],
                "saved": self._saved or None,
                "next_command": self._settings.next_command,
                "has_shirt": self._context.draft.has_shirt,
            },
        )

    def leave(self) -> None:
        if self._tracking is not None:
            self._tracking.stop()
            self._tracking = None

    def _run(self, prepared: CheckTracker) -> None:
        if self._context.draft.has_shirt:
            self._track(prepared)
            self._seek()
        else:
            self._prepared = prepared
            self._phase, self._began_ns = Phase.LEAVING, None

    def _track(self, prepared: CheckTracker) -> None:
        self._tracking = CheckTracking(
            self._context.hub, prepared, self._settings.smoothing, self._shown, self._died
        )

    def _empty_room(self, now_ns: int) -> None:
        """Learns the background for clothes while the room is empty."""
        if self._began_ns is None:
            self._began_ns = now_ns
        elapsed_s = seconds(now_ns - self._began_ns)
        if self._phase is Phase.LEAVING and elapsed_s >= LEAVE_S:
            assert self._prepared is not None
            self._track(self._prepared)
            self._prepared = None
            self._phase, self._began_ns = Phase.EMPTY, now_ns
        elif self._phase is Phase.EMPTY and elapsed_s >= LEARN_S and self._has_learned_room():
            self._context.scene(Scene.MOVING)
            self._seek()

    def _has_learned_room(self) -> bool:
        return self._tracking is not None and self._tracking.metrics().published >= LEARN_SETS

    def _seek(self) -> None:
        self._phase, self._began_ns = Phase.SEEKING, None
        self._problems, self._verdicts = (), ()

    @property
    def _no_person(self) -> Problem:
        reason = None if self._tracking is None else self._tracking.metrics().lost_reason
        if reason is not None:
            return Problem(reason.what, "all cameras", reason.fix)
        return _NOBODY if self._context.draft.has_shirt else _NOBODY_PLAIN

    def _move(self, now_ns: int) -> None:
        assert self._tracking is not None
        self._phase, self._began_ns = Phase.MOVING, now_ns
        self._problems, self._measures = (), []
        self._counts = self._tracking.counts()

    def _judge(self) -> None:
        assert self._tracking is not None
        draft, statuses = self._context.draft, self._context.statuses()
        counts, cameras = self._tracking.counts(), {one.id: one for one in draft.cameras}
        slowness = self._tracking.metrics().slowness
        slow = None if slowness is None else ("too slow", slowness.fix)  # why: see _slowness
        self._verdicts = tuple(
            camera_verdict(
                camera.name,
                self._measures,
                camera_delivery(
                    cameras[camera.name],
                    counts[camera.name].since(self._counts[camera.name]),
                    statuses[camera.name].fps_hz if camera.name in statuses else 0.0,
                    slow,
                ),
                camera.size_px[0],
                draft.has_shirt,
            )
            for camera in self._tracking.rig.cameras
        )
        stature_m = draft.stature_m or self._settings.tracker.stature_m
        hips_m = float(standard_skeleton(stature_m).rest_m[INDEX["hips"], 1])
        of_room = room_problems(self._measures, hips_m, draft.floor_known)
        self._problems = (*self._slowness(), *of_room)
        self._phase = Phase.JUDGED

    def _slowness(self) -> tuple[Problem, ...]:
        """A problem if the machine is too slow."""
        slowness = self._tracking.metrics().slowness if self._tracking is not None else None
        return () if slowness is None else (Problem(slowness.what, "this machine", slowness.fix),)

    def _save(self) -> None:
        if self._phase is not Phase.JUDGED:
            raise InputError(
                "nothing is judged yet", "check", f"stand in view and move for {MOVING_S:.0f} s"
            )
        try:
            draft, state_dir = self._context.draft, self._context.state_dir
            self._saved = str(save_draft(draft, state_dir))
            store_intrinsics(draft, state_dir, datetime.now(UTC))
        except MocapdError as error:
            raise InputError(error.what, error.where, error.fix) from error
        # the lenses are stored now: a second save does not store them again
        self._context.draft = replace(draft, intrinsics_saved=frozenset(draft.intrinsics))
        self._context.on_saved()

    def _status(self) -> tuple[StepState, str, float]:
        """State, sentence and progress."""
        if self._phase is Phase.MISSING:
            return StepState.FAILED, "This cannot be checked yet: see below.", 0.0
        if self._phase is Phase.PREPARING:
            what, share = self._context.job or ("", 0.0)
            return StepState.WORKING, f"Wait: {what or 'preparing the tracker'}.", share
        elapsed_s = seconds(self._now_ns - (self._began_ns or self._now_ns))
        if self._phase is Phase.LEAVING:
            return StepState.WAITING, "Step out of every camera's picture.", elapsed_s / LEAVE_S
        if self._phase is Phase.EMPTY:
            return StepState.WORKING, "Stay out: the empty room is learned.", elapsed_s / LEARN_S
        if self._phase is Phase.SEEKING:
            if self._context.draft.has_shirt:
                return StepState.WAITING, "Stand where all cameras see you.", 0.0
            return StepState.WAITING, "Come back, stand upright, and face the cameras.", 0.0
        if self._phase is Phase.MOVING:
            sentence = "Walk about and move your arms until the bar is full."
            share = min(elapsed_s / MOVING_S, len(self._measures) / LEAST_MEASURES)
            return StepState.WAITING, sentence, share
        if self._saved:
            return StepState.DONE, "Saved. You may close this page.", 1.0
        if self._problems or any(verdict.problem for verdict in self._verdicts):
            return StepState.DONE, "See below what is doubtful; mend it, or save it as it is.", 1.0
        return StepState.DONE, "All is well: save it.", 1.0
