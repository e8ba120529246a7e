"""The step Colour: freezes a picture of each camera, proposes strokes for correction, and solves the light.

Its commands are `step_commands.COLOUR`. Uses the wearer's own colours as soon as every colour has strokes: no two
printers and dyes agree.
"""

import math
import secrets
from collections.abc import Mapping
from dataclasses import replace

from mocapd.boundary.numbers import brief
from mocapd.calibrate.colours.stroke_proposal import Proposal
from mocapd.errors import InputError, MocapdError, Problem
from mocapd.shirt.standard_shirt import standard_shirt
from mocapd.types import LabelledPicture
from mocapd.wizard.colour.canvas import SERVICE, Canvas, canvas_of, outlines, problems_of
from mocapd.wizard.colour.colour_solving import Solution, solve_colours
from mocapd.wizard.colour.still_pictures import Countdown, StillPictures
from mocapd.wizard.colour.stroke_images import decode_strokes
from mocapd.wizard.colour.stroke_proposals import LoadDatabase, pose_database, propose
from mocapd.wizard.commands import Command
from mocapd.wizard.context import Context
from mocapd.wizard.draft import DraftColours
from mocapd.wizard.step import Json, Scene, Shape, StepState, StepView, Tell
from mocapd.wizard.step_commands import COLOUR, Freeze, Personal, Propose, Strokes
from mocapd.wizard.step_names import StepName

_COUNTDOWN_S = 3.0


class ColourStep:
    """A Step; see the module."""

    name = StepName.COLOUR
    verbs = COLOUR

    def __init__(self, context: Context, load: LoadDatabase = pose_database) -> None:
        self._context, self._load = context, load
        # distinguishes keys of pictures from those of an earlier visit
        self._id = secrets.token_hex(4)
        self._take = 0  # of pictures
        self._countdown: Countdown | None = None
        self._now_ns = 0
        self._canvases: dict[str, Canvas] = {}
        self._solution, self._solutions = Solution({}, False, ()), 0
        self._personal = True
        self._troubles: tuple[Problem, ...] = ()
        self._to_propose = False
        self._to_solve = False
        self._proposing = False

    # -- Step ------------------------------------------------------------------------------------

    def enter(self) -> None:
        """Show earlier results again."""
        draft = self._context.draft
        self._context.scene(Scene.T_POSE)
        if draft.colours:
            self._personal = draft.personal
            self._canvases = {
                name: canvas_of(colours.picture) for name, colours in draft.colours.items()
            }
            self._to_solve = True

    def tick(self, now_ns: int) -> None:
        """Count down, take the pictures, start the pending job."""
        self._now_ns = now_ns
        if self._countdown is not None:
            cameras = [camera.id for camera in self._context.draft.cameras]
            frozen = self._countdown.take(
                self._context.hub, cameras or self._context.hub.names, now_ns
            )
            if frozen is not None:
                self._countdown = None
                self._begin(frozen)
        if self._context.job is not None:
            return
        if self._to_propose:
            self._start_proposing()
        elif self._to_solve:
            self._start_solving()

    def command(self, command: Command) -> None:
        match command:
            case Freeze():
                wait_s = _COUNTDOWN_S if command.seconds is None else command.seconds
                self._countdown = Countdown(self._now_ns, wait_s)
            case Propose():
                if not self._canvases:
                    raise InputError("there is no picture yet", "colour", "take the pictures first")
                self._to_propose = True
            case Strokes():
                canvas = self._canvas_of(command.camera)
                strokes = decode_strokes(command.png_base64, canvas.size_px, command.camera)
                canvas.draw(strokes, canvas.drawn.shirt, command.by)
                self._to_solve = True
            case Personal():
                self._personal = command.on
                self._to_solve = True

    def job_failed(self, error: MocapdError) -> None:
        """Drawing by hand always works."""
        self._proposing = False
        self._troubles = (Problem.of(error),)

    def leave(self) -> None:
        """Only the draft stays."""

    # -- work ------------------------------------------------------------------------------------

    def _begin(self, frozen: StillPictures) -> None:
        """Start with new pictures: old strokes are useless, and the light may differ."""
        self._take += 1
        self._canvases = {
            name: canvas_of(LabelledPicture(frame.pixels, frame.pixels[..., 0] * 0))
            for name, frame in frozen.frames.items()
        }
        self._solution = Solution({}, False, ())
        self._troubles = tuple(
            Problem("this camera gave no picture", name, "check its cable, then take them again")
            for name in frozen.missing
        )
        self._to_solve, self._to_propose = False, bool(self._canvases)
        self._keep()

    def _start_proposing(self) -> None:
        self._to_propose, self._proposing = False, True
        context, take = self._context, self._take
        serials = {name: canvas.serial for name, canvas in self._canvases.items()}
        pictures = {name: canvas.drawn.picture.pixels for name, canvas in self._canvases.items()}
        draft, cache_dir, load = context.draft, context.cache_dir, self._load

        def job(report: Tell) -> dict[str, Proposal | InputError]:
            return propose(pictures, draft, cache_dir, report, load)

        def done(proposals: Mapping[str, Proposal | InputError]) -> None:
            self._proposing = False
            if take == self._take:
                self._take_proposals(proposals, serials)

        context.start_job(job, done)

    def _take_proposals(
        self, proposals: Mapping[str, Proposal | InputError], serials: Mapping[str, int]
    ) -> None:
        """`serials`: of the strokes at the start; strokes that the user has drawn since then stay."""
        for name, one in proposals.items():
            canvas = self._canvases[name]
            if isinstance(one, Proposal) and canvas.serial == serials[name]:
                canvas.draw(one.strokes, one.shirt, SERVICE)
        failed = [proposal for proposal in proposals.values() if isinstance(proposal, InputError)]
        self._troubles = tuple({str(error): Problem.of(error) for error in failed}.values())
        self._to_solve = True

    def _start_solving(self) -> None:
        self._to_solve = False
        drawn = {name: canvas.drawn for name, canvas in self._canvases.items()}
        personal, before, take = self._personal, self._solution.cameras, self._take

        def job(report: Tell) -> Solution:
            report("reading the light from the strokes", 0.5)
            return solve_colours(drawn, personal, before)

        def done(solution: Solution) -> None:
            if take == self._take:
                self._solution, self._solutions = solution, self._solutions + 1
                self._keep()

        self._context.start_job(job, done)

    def _keep(self) -> None:
        """Copy good solutions to the draft."""
        context = self._context
        colours = {
            name: DraftColours(camera.drawn.picture, camera.W)
            for name, camera in self._solution.cameras.items()
            if camera.W is not None
        }
        context.draft = replace(context.draft, colours=colours, personal=self._solution.personal)

    def _canvas_of(self, camera: str) -> Canvas:
        if camera not in self._canvases:
            raise InputError(f"no picture of {brief(camera)}", "colour", "take the pictures first")
        return self._canvases[camera]

    # -- view ------------------------------------------------------------------------------------

    def view(self) -> StepView:
        state, sentence, progress = self._status()
        pictures: dict[str, bytes] = {}
        cameras: dict[str, Json] = {}
        problems = list(self._troubles)
        overlays: dict[str, tuple[Shape, ...]] = {}
        for name, canvas in self._canvases.items():
            solved = self._solution.cameras.get(name)
            base = f"colour-{self._id}-{self._take}-{name}"
            cameras[name] = canvas.details(base, solved, self._solutions, pictures)
            if solved is not None:
                problems += problems_of(solved, name)
                overlays[name] = tuple(outlines(solved))
        shirt = standard_shirt()
        details: dict[str, Json] = {
            "phase": "countdown" if self._countdown else "frozen" if self._canvases else "aim",
            "countdown": self._left_s(),
            "proposing": self._proposing,
            "colours": [
                {"id": i + 1, "name": colour, "rgb": shirt.srgb[i].tolist()}
                for i, colour in enumerate(shirt.colour_names)
            ],
            "cameras": cameras,
            "personal": {
                "wanted": self._personal,
                "on": self._solution.personal,
                "missing": list(self._solution.missing),
            },
        }
        return StepView(
            state, sentence, progress, tuple(problems), overlays, details, pictures
        )  # fmt: skip

    def _left_s(self) -> int:
        return math.ceil(self._countdown.left_s(self._now_ns)) if self._countdown else 0

    def _status(self) -> tuple[StepState, str, float]:
        """State, sentence and progress."""
        many = len(self._context.hub.names) > 1
        if self._countdown is not None:
            return StepState.WAITING, f"Hold still, arms out: {self._left_s()}", 0.0
        if not self._canvases:
            viewers = "all cameras see" if many else "the camera sees"
            return (
                StepState.FAILED if self._troubles else StepState.WAITING,
                f"Press “Take the pictures”, then stand where {viewers} the whole shirt, arms out.",
                0.0,
            )
        job = self._context.job
        if self._proposing or self._to_propose:
            what, share = job if job is not None and job[0] else ("starting", 0.0)
            return StepState.WORKING, f"Finding the shirt: {what}.", share
        if job is not None or self._to_solve:
            return StepState.WORKING, "Reading the light from the strokes.", 0.9
        return self._solution_status()

    def _solution_status(self) -> tuple[StepState, str, float]:
        solved = self._solution.cameras
        bad = " and ".join(name for name, solution in solved.items() if solution.W is None)
        empty = " and ".join(name for name in self._canvases if name not in solved)
        if bad:
            return (
                StepState.FAILED,
                f"The strokes of {bad} cannot be right yet: mend them with the brush.",
                0.5,
            )
        if not solved:
            return (
                StepState.FAILED if self._troubles else StepState.WAITING,
                "Choose a colour and paint inside its patch of the shirt, in every picture.",
                0.3,
            )
        if empty:
            return (
                StepState.DONE,
                f"The colours are known, but not for {empty}: draw there too, or go on.",
                1.0,
            )
        return (
            StepState.DONE,
            "The colours are known. Look at them as the tracker sees them, mend strokes, or go on.",
            1.0,
        )
