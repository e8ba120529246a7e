"""The extrinsics without a board: the wearer in the shirt walks about for 20 to 30 s.

Its commands are `step_commands.WEARER_ROOM`.

It needs intrinsics, colours and stature. An existing rig, of cameras that were bumped since, is the initial value of the
search.
"""

import math
import threading
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from mocapd.calibrate.self_calibration.walk_coverage import WalkParams
from mocapd.errors import InputError, MocapdError, Problem
from mocapd.wizard.camera_trouble import stopped_cameras
from mocapd.wizard.colour.stroke_proposals import LoadDatabase, pose_database
from mocapd.wizard.commands import Command
from mocapd.wizard.context import Context
from mocapd.wizard.draft import ExtrinsicsQuality
from mocapd.wizard.extrinsics.rig_plan import plan_of_cameras
from mocapd.wizard.extrinsics.wearer_walk import SEEN, WearerExtrinsics, walk_and_solve
from mocapd.wizard.step import Json, Scene, StepState, StepView
from mocapd.wizard.step_commands import WEARER_ROOM, StartWalk, StopWalk
from mocapd.wizard.step_names import StepName

_SHOWN_PLACES = 12  # of the wearer's path, in the plan of the rig


class ExtrinsicsWithWearer:
    """A Step; see the module. Changes the draft after a solution."""

    name = StepName.ROOM
    verbs = WEARER_ROOM

    def __init__(
        self, context: Context, load: LoadDatabase = pose_database, params: WalkParams | None = None
    ) -> None:
        self._context, self._load = context, load
        self._params = params if params is not None else WalkParams()
        self._walk: threading.Event | None = None  # during a job: a request to stop it
        self._walk_next = False
        self._refusal: Problem | None = None
        self._found: WearerExtrinsics | None = None

    # -- as a Step -------------------------------------------------------------------------------

    def enter(self) -> None:
        self._context.scene(Scene.MOVING)

    def leave(self) -> None:
        """The job ends by itself."""
        self._stop()

    def tick(self, now_ns: int) -> None:
        """Start the pending job."""
        del now_ns
        if self._walk_next and self._context.job is None:
            self._walk_next = False
            self._start()

    def command(self, command: Command) -> None:
        match command:
            case StartWalk():
                missing = self._missing()
                if missing is not None:
                    raise InputError(missing.what, missing.where, missing.fix)
                self._stop()
                self._walk_next = True
            case StopWalk():
                self._stop()

    def job_failed(self, error: MocapdError) -> None:
        """The user may begin again; an existing rig stays."""
        self._walk = None
        self._refusal = Problem.of(error)

    # -- work ------------------------------------------------------------------------------------

    def _start(self) -> None:
        context, walk = self._context, threading.Event()
        self._walk, self._refusal = walk, None
        hub, draft, cache_dir = context.hub, context.draft, context.cache_dir
        load, params = self._load, self._params

        def done(solution: WearerExtrinsics | None) -> None:
            if walk is not self._walk:
                return
            self._walk = None
            if solution is not None:
                self._take(solution)

        context.start_job(
            lambda report: walk_and_solve(hub, draft, cache_dir, walk, report, load, params), done
        )

    def _take(self, solution: WearerExtrinsics) -> None:
        self._found = solution
        residuals = np.array(list(solution.report.residual_px.values()))
        self._context.draft = replace(
            self._context.draft,
            rig=solution.rig,
            floor_known=True,
            extrinsics_quality=ExtrinsicsQuality(
                "wearer",
                float(np.sqrt(np.mean(residuals**2))),
                dict(solution.report.residual_px),
                math.nan,
            ),
        )

    def _stop(self) -> None:
        if self._walk is not None:
            self._walk.set()
            self._walk = None
        self._walk_next = False

    def _missing(self) -> Problem | None:
        """The first missing input."""
        draft = self._context.draft
        if len(draft.cameras) < 2:
            return Problem("one camera makes no room", "room", "use the board, for the floor")
        plain = [c.label or c.id for c in draft.cameras if c.id not in draft.colours]
        if plain:
            return Problem(
                f"the colours of {', '.join(plain)} are not known",
                "colour",
                "do the step Colours first, then come back",
            )
        if draft.stature_m is None:
            return Problem(
                "the wearer's stature is not known",
                "body",
                "type it in the step Body first, then come back",
            )
        return None

    # -- messages --------------------------------------------------------------------------------

    def view(self) -> StepView:
        state, sentence, progress = self._status()
        problems = tuple(self._problems())
        return StepView(state, sentence, progress, problems, {}, self._details())

    @property
    def _busy(self) -> bool:
        return self._walk is not None or self._walk_next

    def _status(self) -> tuple[StepState, str, float]:
        """State, sentence and progress."""
        missing = self._missing()
        if missing is not None:
            return StepState.WAITING, f"{missing.fix[0].upper()}{missing.fix[1:]}.", 0.0
        if self._busy:
            what, share = self._context.job or ("", 0.0)
            if share >= SEEN:
                return (
                    StepState.WORKING,
                    "Working out where the cameras stand. You can rest.",
                    share,
                )
            return StepState.WORKING, f"{what or 'Getting ready'}.", share
        if self._refusal is not None:
            return StepState.FAILED, "Press “Start” to try again, or use the board.", 0.0
        if self._found is not None:
            return StepState.DONE, f"The room is known{self._uncertainty()}. Go on.", 1.0
        return (
            StepState.WAITING,
            "Press “Start”, then walk about in the shirt for half a minute: turn, and move the arms.",
            0.0,
        )

    def _uncertainty(self) -> str:
        """Twice the standard deviations of the least certain camera."""
        assert self._found is not None
        uncertainties = self._found.report.uncertainties.values()
        turn_deg = 2.0 * max(uncertainty.rotation_deg for uncertainty in uncertainties)
        percent = 2.0 * max(uncertainty.distance_percent for uncertainty in uncertainties)
        return f" to about {turn_deg:.0f}° and {percent:.0f} %"

    def _problems(self) -> Iterator[Problem]:
        yield from stopped_cameras(self._context)
        if (missing := self._missing()) is not None:
            yield missing
        if self._refusal is not None:
            yield self._refusal
        elif self._found is not None and not self._busy:
            yield Problem(
                "a room without a board is coarser than one with it",
                "room",
                "use the board when positions matter to the centimetre",
            )

    def _details(self) -> dict[str, Json]:
        solution, draft = self._found, self._context.draft
        quality: dict[str, Json] | None = None
        plan: Json = None
        if solution is not None and draft.extrinsics_quality is not None:
            quality = {
                "rms_px": round(draft.extrinsics_quality.rms_px, 3),
                "play_area_cm": None,
                "cameras": {
                    name: {"rms_px": round(px, 3)}
                    for name, px in solution.report.residual_px.items()
                },
            }
            step = max(1, len(solution.walked_m) // _SHOWN_PLACES)
            plan = {
                **plan_of_cameras(solution.rig),
                "boards_m": np.round(solution.walked_m[::step], 3).tolist(),
            }
        return {
            "stage": "done" if solution is not None else "collect",
            "solving": self._busy,
            "names": {camera.id: camera.label or camera.id for camera in draft.cameras},
            "floor_known": solution is not None,
            "quality": quality,
            "plan": plan,
            "actions": self._actions(),
        }

    def _actions(self) -> list[Json]:
        if self._busy:
            return [{"verb": "stop", "text": "Stop"}]
        if self._missing() is not None:
            return []
        return [{"verb": "walk", "text": "Start again" if self._found is not None else "Start"}]
