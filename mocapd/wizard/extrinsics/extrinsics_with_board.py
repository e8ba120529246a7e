"""The extrinsics with the board: held where cameras see it together, then laid on the floor.

Its commands are `step_commands.BOARD_ROOM`.
"""

from collections.abc import Iterator
from dataclasses import replace
from enum import StrEnum
from itertools import combinations

from mocapd.calibrate.board.back_side import gluing_trouble
from mocapd.calibrate.board.board_at_rest import (
    LONG_NS,
    BoardAtRest,
    lies_on_its_face,
    looks_like_floor,
)
from mocapd.calibrate.board.board_instant import BoardInstant
from mocapd.calibrate.extrinsics.board_collection import ENOUGH, BoardCollection
from mocapd.calibrate.extrinsics.board_extrinsics import (
    SceneExtrinsics,
    WorldExtrinsics,
    lone_camera,
    place_in_world,
    with_board,
)
from mocapd.calibrate.extrinsics.contradictions import ContradictionError
from mocapd.calibrate.extrinsics.live_extrinsics import PARAMS, solve_live
from mocapd.errors import ConfigError, InputError, MocapdError, Problem
from mocapd.wizard.board.board_advice import BoardAdvice
from mocapd.wizard.board.board_form import usual_board
from mocapd.wizard.board.board_watch import BoardWatch, index_after
from mocapd.wizard.camera_trouble import stopped_cameras
from mocapd.wizard.commands import Command
from mocapd.wizard.context import Context
from mocapd.wizard.draft import ExtrinsicsQuality
from mocapd.wizard.extrinsics.board_request import board_request
from mocapd.wizard.extrinsics.rig_plan import plan_of, quality_of
from mocapd.wizard.step import Json, Scene, StepState, StepView, Tell
from mocapd.wizard.step_commands import BOARD_ROOM, Floor, SkipFloor, Solve
from mocapd.wizard.step_names import StepName

_FACING = (
    "; cameras that face each other need a board printed on both sides (mocapd board --two-sided)"
)
_PATIENCE_NS = 8_000_000_000  # before the message that a camera shares no sighting


class BoardPhase(StrEnum):
    COLLECT = "collect"
    FLOOR = "floor"
    DONE = "done"


class ExtrinsicsWithBoard:
    """A Step; see the module. Changes the draft after measuring or skipping the floor."""

    name = StepName.ROOM
    verbs = BOARD_ROOM

    def __init__(self, context: Context) -> None:
        draft = context.draft
        self._context = context
        self._cameras = draft.cameras
        self._names = {camera.id: camera.label or camera.id for camera in draft.cameras}
        self._spec = draft.board or usual_board()
        self._collection = self._start_over()
        self._earlier = frozenset(index for own in draft.board_views.values() for index in own)
        first = index_after(draft.board_views)
        self._watch = BoardWatch(context.hub, self._names, self._spec, first)
        self._advice = BoardAdvice(context, lambda _spec: None)
        self._rest = BoardAtRest()
        self._stage = BoardPhase.COLLECT
        self._asked = False  # the user asked to solve with the present sightings
        self._solving = False
        self._now_ns = 0
        self._begun_ns: int | None = None
        self._refusal: Problem | None = None
        self._extrinsics: SceneExtrinsics | None = None
        self._made: WorldExtrinsics | None = None
        self._plan: Json = None

    # -- as a Step -------------------------------------------------------------------------------

    def enter(self) -> None:
        self._watch.start()
        if len(self._cameras) == 1:
            one = self._cameras[0]
            intrinsics = self._context.draft.intrinsics[one.id]
            self._extrinsics = lone_camera(one.id, one.size_px, intrinsics, self._spec)
            self._to_floor()
        else:
            self._context.scene(Scene.ROOM)

    def leave(self) -> None:
        self._watch.stop()

    def tick(self, now_ns: int) -> None:
        self._now_ns = now_ns
        self._begun_ns = now_ns if self._begun_ns is None else self._begun_ns
        if self._stage is BoardPhase.DONE:
            return
        instant = self._watch.instant()
        if instant is not None:
            self._advice.take(instant)
            if self._stage is BoardPhase.COLLECT:
                self._collection.offer(instant)
            else:
                self._watch_floor(instant)
            self._advice.ask(now_ns, instant.frames, self._spec)
        if (
            self._stage is BoardPhase.COLLECT
            and self._context.job is None
            and (self._asked or self._collection.due)
        ):
            self._solve()

    def command(self, command: Command) -> None:
        match command:
            case Floor():
                self._floor_by_hand()
            case SkipFloor():
                self._skip_floor()
            case Solve():
                if self._stage is not BoardPhase.COLLECT or not self._collection.solvable:
                    raise InputError(
                        "there is nothing to solve yet",
                        "room",
                        "show the board to pairs of cameras",
                    )
                self._asked = True

    def job_failed(self, error: MocapdError) -> None:
        if not self._solving:
            return
        self._solving = False
        self._refusal = Problem.of(error)
        if isinstance(error, ContradictionError):
            # the wrong ones cannot be identified
            self._collection = self._start_over()

    def view(self) -> StepView:
        state = StepState.WAITING
        if self._stage is BoardPhase.DONE:
            state = StepState.DONE
        elif self._solving:
            state = StepState.WORKING
        elif self._refusal is not None:
            state = StepState.FAILED
        overlays = self._watch.shapes(self._now_ns, self._collection.still_px())
        return StepView(
            state,
            self._sentence(),
            self._progress(),
            tuple(self._problems()),
            {} if self._stage is BoardPhase.DONE else overlays,
            self._details(),
        )

    # -- sightings -------------------------------------------------------------------------------

    def _start_over(self) -> BoardCollection:
        """The sightings of the step Lens only."""
        sizes_px = {camera.id: camera.size_px for camera in self._cameras}
        return BoardCollection(sizes_px, self._spec, self._context.draft.board_views)

    def _solve(self) -> None:
        self._collection.try_now()
        self._asked, self._solving = False, True
        views, spec, earlier = self._collection.views, self._spec, self._earlier
        measured = self._context.draft.intrinsics
        intrinsics_of = {camera.id: measured[camera.id] for camera in self._cameras}

        def job(report: Tell) -> tuple[SceneExtrinsics, WorldExtrinsics]:
            report("the room", 0.0)
            return solve_live(intrinsics_of, spec, views, earlier)

        def done(solution: tuple[SceneExtrinsics, WorldExtrinsics]) -> None:
            self._solving = False
            self._extrinsics, self._made = solution
            self._plan = plan_of(*solution)
            self._to_floor()

        self._context.start_job(job, done)

    # -- floor -----------------------------------------------------------------------------------

    def _to_floor(self) -> None:
        self._stage, self._refusal = BoardPhase.FLOOR, None
        self._rest.forget()
        self._context.scene(Scene.FLOOR)

    def _watch_floor(self, instant: BoardInstant) -> None:
        still = {
            name: self._collection.still(name, observation)
            for name, observation in instant.observations.items()
        }
        self._rest.take(instant, still)
        extrinsics = self._extrinsics
        if extrinsics is None or self._rest.since_ns < LONG_NS or not self._rest.has_enough:
            return
        views = self._rest.views()
        try:
            # a board with its back up gets an error with the remedy
            if looks_like_floor(extrinsics, views) or lies_on_its_face(extrinsics, views):
                self._lay_down()
        except ConfigError as error:
            self._refusal = Problem.of(error)
            self._rest.forget()

    def _floor_by_hand(self) -> None:
        if self._extrinsics is None:
            raise InputError(
                "the cameras' places are not known yet", "room", "hold the board before the cameras"
            )
        if not self._rest.has_enough:
            raise InputError(
                "no camera sees the board lie still",
                "the floor",
                "lay it on the floor, printed side up, where a camera sees all of it",
            )
        try:
            self._lay_down()
        except ConfigError as error:
            self._rest.forget()
            raise InputError(error.what, error.where, error.fix) from None

    def _lay_down(self) -> None:
        """Raises ConfigError when the board does not lie on the floor."""
        assert self._extrinsics is not None
        views = self._rest.views()
        index = next(iter(views.values())).index
        extrinsics = with_board(self._extrinsics, index, views)
        made = place_in_world(extrinsics, index, "the floor", PARAMS)
        self._finish(extrinsics, made, floor_known=True)

    def _skip_floor(self) -> None:
        if self._extrinsics is None or self._made is None:
            raise InputError(
                "the cameras' places are not known yet",
                "room",
                "lay the board on the floor"
                if len(self._cameras) == 1
                else "hold the board before the cameras",
            )
        self._finish(self._extrinsics, self._made, floor_known=False)

    def _finish(
        self, extrinsics: SceneExtrinsics, made: WorldExtrinsics, floor_known: bool
    ) -> None:
        self._stage, self._refusal = BoardPhase.DONE, None
        self._extrinsics, self._made, self._plan = extrinsics, made, plan_of(extrinsics, made)
        area = made.play_area
        self._context.draft = replace(
            self._context.draft,
            board=self._spec,
            board_views=self._collection.views,
            rig=made.rig,
            floor_known=floor_known,
            extrinsics_quality=ExtrinsicsQuality(
                "board",
                made.rms_px,
                {name: fit.rms_px for name, fit in made.cameras.items()},
                float("nan") if area is None else area.median_cm,
            ),
        )
        self._context.scene(Scene.EMPTY)

    # -- messages --------------------------------------------------------------------------------

    def _sentence(self) -> str:
        if self._stage is BoardPhase.DONE:
            return "The room is known. Go on."
        if self._stage is BoardPhase.FLOOR:
            if self._rest.has_enough:
                return "Leave the board where it lies."
            side = "the side that says FRONT up" if self._spec.two_sided else "printed side up"
            return f"Lay the board on the floor, {side}, in the middle of where players stand."
        if self._solving:
            return "Working out where the cameras stand. You can go on showing the board."
        apart = self._collection.apart()
        lonely = self._names[apart[0]] if apart and len(self._cameras) > 2 else None
        return board_request(self._spec.two_sided, lonely)

    def _progress(self) -> float:
        if self._stage is BoardPhase.DONE:
            return 1.0
        if self._stage is BoardPhase.FLOOR:
            return 0.75 + 0.2 * min(1.0, self._rest.since_ns / LONG_NS)
        return 0.7 * self._collection.progress

    def _problems(self) -> Iterator[Problem]:
        yield from stopped_cameras(self._context)
        gluing = None if self._made is None else self._made.gluing
        if self._stage is not BoardPhase.COLLECT and gluing and (trouble := gluing_trouble(gluing)):
            yield Problem(trouble, "the board")
        if self._stage is BoardPhase.DONE:
            if not self._context.draft.floor_known:
                yield Problem(
                    "the floor is guessed: up from the cameras, height from the board's lowest place",
                    "the floor",
                    "begin again and lay the board on the floor for a true one",
                )
            return
        if self._refusal is not None:
            yield self._refusal
        patient = self._begun_ns is None or self._now_ns - self._begun_ns < _PATIENCE_NS
        if self._stage is BoardPhase.COLLECT and not patient:
            for name in self._collection.lonely():
                yield Problem(
                    "it never sees the board at the same moment as another camera",
                    self._names[name],
                    "hold the board still where it and another camera see it, or turn them together"
                    + ("" if self._spec.two_sided else _FACING),
                )
        # for the floor one camera with the board is enough
        wanted = {camera.id: self._stage is BoardPhase.COLLECT for camera in self._cameras}
        yield from self._advice.problems(self._now_ns, wanted)

    def _details(self) -> dict[str, Json]:
        return {
            "stage": self._stage.value,
            "solving": self._solving,
            "names": dict(self._names),
            "moments": self._collection.count,
            "enough": ENOUGH,
            "pairs": [
                {"a": a, "b": b, "shared": self._collection.common_count(a, b)}
                for a, b in combinations(self._names, 2)
            ],
            "at_rest": self._rest.has_enough,
            "can_solve": self._stage is BoardPhase.COLLECT and self._collection.solvable,
            "can_skip_floor": self._stage is BoardPhase.FLOOR and self._made is not None,
            "floor_known": self._stage is BoardPhase.DONE and self._context.draft.floor_known,
            "quality": None if self._made is None else quality_of(self._made),
            "plan": self._plan,
        }
