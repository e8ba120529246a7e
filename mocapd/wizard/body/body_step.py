"""The step Body: the wearer types the stature, and bends the arms while the proportions are measured.

Its commands are `step_commands.BODY`.
"""

from collections.abc import Mapping
from dataclasses import replace

from mocapd.body.shape import mean_shape
from mocapd.calibrate.body_shape.body_scale import lengths_cm, scale_trouble
from mocapd.errors import InputError, MocapdError, Problem
from mocapd.wizard.body.body_measuring import (
    READY,
    SEEN,
    BodyMeasurement,
    BodyWatch,
    MakeTracker,
    measure,
    measuring_tracker,
)
from mocapd.wizard.bone_shapes import bone_shapes
from mocapd.wizard.colour.stroke_images import encode_picture
from mocapd.wizard.commands import Command
from mocapd.wizard.context import Context
from mocapd.wizard.step import Json, Scene, Shape, StepState, StepView
from mocapd.wizard.step_commands import BODY, MeasureBody, SkipBody, Stature
from mocapd.wizard.step_names import StepName

# lifetime of the body drawn over the newest picture: arms move 20 cm in that time
OLDEST_NS = 200_000_000


class BodyStep:
    """A Step; see the module."""

    name = StepName.BODY
    verbs = BODY

    def __init__(self, context: Context, make_tracker: MakeTracker = measuring_tracker) -> None:
        self._context, self._make_tracker = context, make_tracker
        self._watched: BodyWatch | None = None  # during a measuring job
        self._skipped = False
        self._measure_next = False
        self._times = 0  # completed measurements
        self._pictures: dict[str, bytes] = {}
        self._troubles: tuple[Problem, ...] = ()
        self._now_ns = 0

    # -- Step ------------------------------------------------------------------------------------

    def enter(self) -> None:
        """Earlier input and measurements stay."""
        self._context.scene(Scene.ARM_BENDS)

    def tick(self, now_ns: int) -> None:
        """Start the pending job."""
        self._now_ns = now_ns
        if self._measure_next and self._context.job is None:
            self._measure_next = False
            self._start()

    def command(self, command: Command) -> None:
        match command:
            case Stature():
                self._set_stature(command.m)
            case MeasureBody():
                missing = self._missing()
                if missing is not None:
                    raise InputError(missing.what, "body", missing.fix)
                self._stop()
                self._measure_next, self._skipped = True, False
            case SkipBody():
                if self._context.draft.stature_m is None:
                    raise InputError("the stature is not known", "body", "type it first")
                self._stop()
                self._forget()
                self._skipped = True

    def job_failed(self, error: MocapdError) -> None:
        """The user may measure again, or skip the step."""
        self._watched = None
        self._troubles = (Problem.of(error),)

    def leave(self) -> None:
        """The job ends by itself."""
        self._stop()

    # -- work ------------------------------------------------------------------------------------

    def _set_stature(self, m: float) -> None:
        context = self._context
        if context.draft.stature_m == m:
            return
        self._stop()
        context.draft = replace(context.draft, stature_m=m)
        self._forget()  # proportions are relative to the stature

    def _forget(self) -> None:
        self._pictures, self._troubles = {}, ()
        self._context.draft = replace(self._context.draft, factors=None)

    def _start(self) -> None:
        context, watched = self._context, BodyWatch()
        self._watched, self._troubles = watched, ()
        hub, draft, cache_dir = context.hub, context.draft, context.cache_dir
        make_tracker = self._make_tracker

        def done(measured: BodyMeasurement | None) -> None:
            if watched is self._watched:
                self._watched = None
                if measured is not None:
                    self._found(measured)

        context.start_job(
            lambda report: measure(hub, draft, cache_dir, watched, report, make_tracker), done
        )

    def _found(self, measured: BodyMeasurement) -> None:
        draft = self._context.draft
        self._times += 1
        self._pictures = {
            f"body-{self._times}-{name}.jpg": encode_picture(pixels)
            for name, pixels in measured.pictures.items()
        }
        self._context.draft = replace(draft, factors=measured.shape.factors)
        by_wearer = (
            draft.extrinsics_quality is not None and draft.extrinsics_quality.method == "wearer"
        )
        trouble = scale_trouble(measured.scale, measured.shape.stature_m, by_wearer)
        self._troubles = () if trouble is None else (trouble,)

    def _stop(self) -> None:
        if self._watched is not None:
            self._watched.stop.set()
            self._watched = None
        self._measure_next = False

    def _missing(self) -> Problem | None:
        """Why measuring is impossible."""
        draft = self._context.draft
        if draft.stature_m is None:
            return Problem("the stature is not known", "", "type it first")
        if not draft.has_shirt:
            return Problem("they are measured with the shirt", "", "go on with the stature alone")
        if draft.rig is None:
            return Problem("the room is not known", "", "do the step Room first")
        if not set(draft.colours) & set(draft.rig.names):
            return Problem("the colours are not known", "", "do the step Colours first")
        if len(draft.rig.cameras) < 2:
            return Problem(
                "one camera cannot separate size from distance", "", "go on with the stature alone"
            )
        return None

    # -- view ------------------------------------------------------------------------------------

    def view(self) -> StepView:
        draft = self._context.draft
        state, sentence, progress = self._status()
        missing = self._missing()
        usual = shape = None if draft.stature_m is None else mean_shape(draft.stature_m)
        if usual is not None and draft.factors is not None:
            shape = replace(usual, factors=draft.factors)
        details: dict[str, Json] = {
            "stature_m": draft.stature_m,
            "has_shirt": draft.has_shirt,
            "measuring": self._busy,
            "can_measure": missing is None,
            "why_not": "" if missing is None else missing.what,
            "measured": draft.factors is not None,
            "lengths_cm": {} if shape is None else lengths_cm(shape),
            "usual_cm": {} if usual is None else lengths_cm(usual),
            "pictures": list(self._pictures),
        }
        return StepView(
            state, sentence, progress, self._troubles, self._overlays(), details, self._pictures
        )

    @property
    def _busy(self) -> bool:
        return self._watched is not None or self._measure_next

    def _overlays(self) -> Mapping[str, tuple[Shape, ...]]:
        """The tracked bones during measuring, unless they are older than the pictures."""
        rig = self._context.draft.rig
        shown = self._watched.body if self._watched is not None else None
        if rig is None or shown is None or self._now_ns - shown[0].t_ns > OLDEST_NS:
            return {}
        return {camera.name: bone_shapes(camera, *shown) for camera in rig.cameras}

    def _status(self) -> tuple[StepState, str, float]:
        """State, sentence and progress."""
        draft = self._context.draft
        if draft.stature_m is None:
            return StepState.WAITING, "Type how tall you are, without shoes.", 0.0
        if self._busy:
            what, share = self._context.job or ("", 0.0)
            if share < READY:
                return StepState.WORKING, f"Getting ready: {what or 'one observation'}.", share
            if share < SEEN:
                return StepState.WORKING, f"{what}.", share
            return StepState.WORKING, "Working out your proportions.", share
        if draft.factors is not None and not draft.has_shirt:
            return StepState.DONE, "Your proportions are known from before. Go on.", 1.0
        if draft.factors is not None:
            return (
                StepState.DONE,
                "Compare the lines with your body: measure again if they are off, or go on.",
                1.0,
            )
        if self._skipped:
            return StepState.DONE, "Your stature alone is used. Go on, or measure after all.", 1.0
        missing = self._missing()
        if missing is not None:
            return (
                StepState.DONE,
                f"Your stature is known. No proportions are measured: {missing.what}.",
                1.0,
            )
        if self._troubles:
            return StepState.FAILED, "Press “Measure” to try again, or go on without.", 0.3
        return (
            StepState.WAITING,
            "Press “Measure”, stand with both arms out, then bend and stretch your elbows.",
            0.3,
        )
