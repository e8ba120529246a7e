"""The step Lens: collects pictures of the board in every camera, and solves its intrinsics when there are enough.

Its commands are `step_commands.LENS`.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from mocapd.boundary.numbers import brief
from mocapd.calibrate.board.board_instant import BoardInstant
from mocapd.calibrate.board.board_sightings import BoardSightings
from mocapd.calibrate.intrinsics.intrinsics import Intrinsics
from mocapd.calibrate.intrinsics.view_picking import PickedViews
from mocapd.calibration.board_spec import BoardSpec, corners_m
from mocapd.errors import ConfigError, InputError, MocapdError, Problem
from mocapd.wizard.board.board_advice import BoardAdvice
from mocapd.wizard.board.board_form import (
    board_of,
    form_of,
    is_rescaled,
    same_print,
    scaled_board,
    usual_board,
)
from mocapd.wizard.board.board_watch import BoardWatch, index_after
from mocapd.wizard.camera_trouble import stopped_cameras
from mocapd.wizard.commands import Command
from mocapd.wizard.context import Context
from mocapd.wizard.draft import without_room
from mocapd.wizard.intrinsics.intrinsics_views import CameraIntrinsics, IntrinsicsOffer
from mocapd.wizard.intrinsics.saved_intrinsics import (
    SavedIntrinsics,
    find_saved_intrinsics,
    read_intrinsics,
)
from mocapd.wizard.step import Scene, Shape, StepState, StepView, Tell
from mocapd.wizard.step_commands import LENS, Board, Finish, MeasureLens, Ruler, UseSaved
from mocapd.wizard.step_names import StepName

_SEEN_NS = 500_000_000  # how long a camera counts as the user's target after a sighting


class IntrinsicsStep:
    """A Step: collects pictures of the board in all cameras at once, and solves the intrinsics one after the other."""

    name = StepName.LENS
    verbs = LENS

    def __init__(self, context: Context) -> None:
        """Raises InputError without cameras."""
        cameras = context.draft.cameras
        if not cameras:
            raise InputError("no camera has been chosen", "lens", "do the step Cameras first")
        self._context = context
        self._spec = context.draft.board or usual_board()
        # the views of an earlier visit stay for the cameras whose lens stays
        first = index_after(context.draft.board_views)
        self._watch = BoardWatch(context.hub, [camera.id for camera in cameras], self._spec, first)
        self._advice = BoardAdvice(context, self._found_variant)
        self._note = ""
        self._now_ns = 0
        self._round = 0
        self._solving: CameraIntrinsics | None = None
        self._damaged: tuple[Problem, ...] = ()
        self._begin()
        self._offer()

    # -- Step ------------------------------------------------------------------------------------

    def enter(self) -> None:
        self._watch.start()
        self._context.scene(Scene.LENS)

    def leave(self) -> None:
        self._watch.stop()

    def tick(self, now_ns: int) -> None:
        self._now_ns = now_ns
        if self._done():
            return
        instant = self._watch.instant()
        if instant is not None:
            self._take(instant, now_ns)
        if self._context.job is None:
            self._solve_next()

    def command(self, command: Command) -> None:
        match command:
            case Board():
                self._change_board(board_of(command, self._spec))
            case Ruler():
                self._change_board(scaled_board(self._spec, command.mm))
            case UseSaved(camera=None):
                self._use_saved(list(self._cameras.values()))
            case UseSaved(camera=str(camera)):
                self._use_saved([self._require_camera(camera)])
            case MeasureLens():
                self._require_camera(command.camera).use(None)
            case Finish():
                self._finish()

    def job_failed(self, error: MocapdError) -> None:
        one, self._solving = self._solving, None
        if one is not None:
            one.refuse(error, len(one.picked.views))

    def view(self) -> StepView:
        cameras = self._cameras.values()
        state = StepState.DONE if self._done() else StepState.WAITING
        if state is StepState.WAITING and any(
            camera.refusal and not camera.intrinsics for camera in cameras
        ):
            state = StepState.FAILED
        return StepView(
            state,
            self._sentence(),
            float(np.mean([camera.progress() for camera in cameras])),
            self._problems(),
            self._overlays(),
            {
                "board": form_of(self._spec),
                "note": self._note,
                "cameras": {id_: camera.details() for id_, camera in self._cameras.items()},
                "finishable": all(camera.by_hand() is not None for camera in cameras),
                "solving": self._solving.name if self._solving is not None else None,
            },
        )

    # -- collecting ------------------------------------------------------------------------------

    def _begin(self) -> None:
        """Discard all pictures."""
        board_m = corners_m(self._spec)
        cameras = self._context.draft.cameras
        self._cameras = {
            camera.id: CameraIntrinsics(camera, PickedViews(camera.size_px, board_m))
            for camera in cameras
        }
        self._sightings = BoardSightings({camera.id: camera.size_px for camera in cameras}, board_m)
        self._round += 1  # ignores the result of a job of an earlier round

    def _take(self, instant: BoardInstant, now_ns: int) -> None:
        self._advice.take(instant)
        together = self._sightings.offer(instant)
        for id_, observation in instant.observations.items():
            one = self._cameras[id_]
            view = observation.view
            if one.intrinsics is not None or not one.picked.offer(view, observation.motion_px):
                continue
            if not (together and self._sightings.still(id_, observation)):
                one.picked.views[-1] = self._sightings.add_alone(id_, view)
        wanted = {
            id_: frame for id_, frame in instant.frames.items() if not self._cameras[id_].intrinsics
        }
        self._advice.ask(now_ns, wanted, self._spec)

    def _found_variant(self, spec: BoardSpec) -> None:
        ink = "light on dark" if spec.inverted else "dark on light"
        layout = ", of the layout before OpenCV 4.6" if spec.legacy else ""
        self._change_board(spec)
        self._note = f"The board in the pictures is {ink}{layout}; it was set so."

    def _change_board(self, spec: BoardSpec) -> None:
        if spec == self._spec:
            return
        old, self._spec, self._note = self._spec, spec, ""
        if not same_print(old, spec):
            offers = {id_: (camera.offered, camera.taken) for id_, camera in self._cameras.items()}
            self._begin()
            for id_, (offered, taken) in offers.items():
                self._cameras[id_].offered = offered
                self._cameras[id_].use(taken)
        # otherwise corners stay valid, and intrinsics do not depend on the scale of the board
        self._watch.change(spec)
        self._advice.forget()
        self._write_when_done()

    # -- solving ---------------------------------------------------------------------------------

    def _solve_next(self) -> None:
        due = [camera for camera in self._cameras.values() if camera.due()]
        if not due:
            return
        one = max(due, key=lambda camera: camera.picked.progress())
        count, board_m, begun_in = len(one.picked.views), corners_m(self._spec), self._round
        views = tuple(one.picked.views)
        self._solving = one

        def job(report: Tell) -> Intrinsics:
            report(f"the lens of {one.name}", 0.0)
            return one.solve(views, board_m)

        def done(intrinsics: Intrinsics) -> None:
            self._solving = None
            if begun_in == self._round and one.intrinsics is None:
                one.take(intrinsics, count)
                self._write_when_done()

        self._context.start_job(job, done)

    def _finish(self) -> None:
        for camera in self._cameras.values():
            if camera.by_hand() is None:
                raise InputError(
                    "its lens is not known well enough yet", camera.name, "show it the board on"
                )
        for one in self._cameras.values():
            one.intrinsics = one.by_hand()
        self._write_when_done()

    def _done(self) -> bool:
        return all(camera.intrinsics is not None for camera in self._cameras.values())

    def _write_when_done(self) -> None:
        if not self._done():
            return
        lenses = {id_: camera.intrinsics for id_, camera in self._cameras.items()}
        draft, quality = self._context.draft, self._context.draft.extrinsics_quality
        by_board = quality is not None and quality.method == "board"
        # what was measured by the board at a wrong size, or by another lens, is wrong, too
        if by_board and draft.board is not None and is_rescaled(draft.board, self._spec):
            draft = without_room(replace(draft, factors=None))
        if any(lens is not draft.intrinsics.get(id_) for id_, lens in lenses.items()):
            draft = without_room(draft)
        earlier = draft.board_views if draft.board and same_print(draft.board, self._spec) else {}
        taken = {id_: camera.taken for id_, camera in self._cameras.items() if camera.taken}
        saved = {id_ for id_, offer in taken.items() if offer.from_file}
        of_draft = taken.keys() - saved
        self._context.draft = replace(
            draft,
            board=self._spec,
            board_views={
                id_: earlier.get(id_, {}) if id_ in of_draft else own
                for id_, own in self._sightings.views.items()
            },
            intrinsics={id_: lens for id_, lens in lenses.items() if lens is not None},
            intrinsics_saved=frozenset(saved | (draft.intrinsics_saved & of_draft)),
        )

    # -- earlier intrinsics ----------------------------------------------------------------------

    def _offer(self) -> None:
        """Offer intrinsics of this setup, or else of the file of earlier ones."""
        saved: tuple[SavedIntrinsics, ...] = ()
        try:
            saved = read_intrinsics(self._context.state_dir)
        except ConfigError as error:
            self._damaged = (Problem.of(error),)
        for id_, camera in self._cameras.items():
            intrinsics = self._context.draft.intrinsics.get(id_)
            stored = find_saved_intrinsics(camera.camera, saved)
            if intrinsics is not None and intrinsics.size_px == camera.camera.size_px:
                camera.offered = IntrinsicsOffer(intrinsics, "", from_file=False)
            elif stored is not None:
                camera.offered = IntrinsicsOffer(
                    stored.intrinsics(), f"{stored.when:%Y-%m-%d}", from_file=True
                )

    def _use_saved(self, cameras: Sequence[CameraIntrinsics]) -> None:
        offered = [camera for camera in cameras if camera.offered is not None]
        if not offered:
            raise InputError("there is no earlier lens", cameras[0].name, "show it the board")
        for one in offered:
            one.use(one.offered)
        self._write_when_done()

    def _require_camera(self, camera: str) -> CameraIntrinsics:
        if camera not in self._cameras:
            raise InputError(f"no camera {brief(camera)}", "lens", "reload the page")
        return self._cameras[camera]

    # -- messages --------------------------------------------------------------------------------

    def _sentence(self) -> str:
        if self._done():
            return "All lenses are known. Go on to the room."
        left = {id_: camera for id_, camera in self._cameras.items() if camera.intrinsics is None}
        newest = {
            id_: observation
            for id_, observation in self._watch.newest.items()
            if id_ in left and self._now_ns - observation.t_ns <= _SEEN_NS
        }
        if not newest:
            if not any(camera.picked.views for camera in left.values()):
                return (
                    "Show the board to the cameras, so near that it fills a third of the picture."
                )
            # the unfinished camera with most progress
            return max(left.values(), key=lambda camera: camera.picked.progress()).sentence()
        camera = max((left[id_] for id_ in newest), key=lambda camera: camera.picked.progress())
        if all(not left[id_].picked.still(at.motion_px) for id_, at in newest.items()):
            return "Hold the board still for a moment."
        return camera.sentence()

    def _overlays(self) -> dict[str, tuple[Shape, ...]]:
        if self._done():
            return {}
        corners = self._watch.shapes(self._now_ns, self._sightings.still_px())
        return {
            id_: (*(camera.cells() if camera.intrinsics is None else ()), *corners.get(id_, ()))
            for id_, camera in self._cameras.items()
        }

    def _problems(self) -> tuple[Problem, ...]:
        left = {id_: camera.intrinsics is None for id_, camera in self._cameras.items()}
        stopped = stopped_cameras(self._context)
        refused = tuple(
            camera.refusal
            for camera in self._cameras.values()
            if camera.refusal and not camera.intrinsics
        )
        advice = () if self._done() else self._advice.problems(self._now_ns, left)
        return (*self._damaged, *stopped, *refused, *advice)
