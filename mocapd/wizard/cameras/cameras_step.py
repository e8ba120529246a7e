"""The step Cameras: checks each camera, lets it settle, and locks it.

Its commands are `step_commands.CAMERAS`.

`details`: `cameras`: [{id, label, source, size_px, fps_hz, measured_hz, taken, phase, share, lockable,
controls: {name: value}, problems: [{what, where, fix}], offer: {size_px, fps_hz} or null}], `others`:
[{node, name, source, problem, fix, note}], the nodes that are not in use.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, replace

from mocapd.boundary.numbers import brief
from mocapd.boundary.urls import without_password
from mocapd.calibrate.light.light_check import light_problems
from mocapd.calibrate.verification.delivery import Grade, delivery_judgements
from mocapd.capture.camera_thread.capture_status import CaptureState, CaptureStatus
from mocapd.capture.webcam.usb_bandwidth import Mode
from mocapd.capture.webcam.webcam_listing import CameraInfo
from mocapd.clock import NS_PER_S
from mocapd.errors import InputError, MocapdError, Problem
from mocapd.pipeline.other_programs import OtherPrograms
from mocapd.wizard.camera_delivery import camera_delivery
from mocapd.wizard.camera_trouble import too_few_cameras
from mocapd.wizard.cameras.camera_locking import CameraLocking, LockPhase
from mocapd.wizard.cameras.camera_locks import CameraLocks
from mocapd.wizard.cameras.camera_nodes import node_of, offers, unused_nodes
from mocapd.wizard.cameras.machine_watch import MachineWatch
from mocapd.wizard.cameras.picture_watch import PictureWatch
from mocapd.wizard.commands import Command, OfCamera
from mocapd.wizard.context import Context
from mocapd.wizard.draft import DraftCamera, with_cameras
from mocapd.wizard.step import Json, StepState, StepView
from mocapd.wizard.step_commands import CAMERAS, ChangeMode, LeaveOut, Lock, Name, TakeIn
from mocapd.wizard.step_names import StepName

_LIST_EVERY_NS = 4 * NS_PER_S
_LIGHT_EVERY_NS = NS_PER_S // 2
_JUDGED_NS = 2 * NS_PER_S  # of frames for the judgement of a camera that is too slow
_ENOUGH_RATE = 0.8  # of the requested rate


class CamerasStep:
    """A Step. Args:
    cameras: the host's open cameras, in the order of the hub;
    nodes: lists the machine's cameras (`list_cameras`); () where they are simulated;
    locks: the host's, see CameraLocks; load: of this machine, see MachineWatch.
    """

    name = StepName.CAMERAS
    verbs = CAMERAS

    def __init__(
        self,
        context: Context,
        cameras: tuple[DraftCamera, ...],
        nodes: Callable[[], tuple[CameraInfo, ...]],
        locks: CameraLocks,
        load: OtherPrograms | None = None,
    ) -> None:
        self._context, self._list_nodes, self._locks = context, nodes, locks
        earlier = {camera.id: camera for camera in context.draft.cameras}
        self._cameras = {camera.id: earlier.get(camera.id, camera) for camera in cameras}
        self._left_out = {camera.id for camera in cameras if earlier and camera.id not in earlier}
        self._watch = PictureWatch(self._cameras)
        self._machine = MachineWatch(load if load is not None else OtherPrograms())
        self._locking = {name: self._new_locking(camera) for name, camera in self._cameras.items()}
        self._nodes: tuple[CameraInfo, ...] = ()
        self._list_trouble: tuple[Problem, ...] = ()
        self._listed_ns: int | None = None
        self._lit_ns = 0
        self._light: dict[str, tuple[Problem, ...]] = {}
        self._offers: dict[str, Mode] = {}
        self._crowded: tuple[Problem, ...] = ()
        self._statuses: Mapping[str, CaptureStatus] = {}

    def enter(self) -> None:
        self._context.hub.join(self._watch)

    def leave(self) -> None:
        """See Step. Controls stay locked: the host restores them at the end."""
        self._context.hub.leave(self._watch)

    def tick(self, now_ns: int) -> None:
        self._statuses = self._context.statuses()
        self._machine.tick(now_ns)
        for name in self._active_names:
            self._locking[name].tick(now_ns, self._is_live(name))
        due = self._listed_ns is None or now_ns - self._listed_ns > _LIST_EVERY_NS
        if due and self._context.job is None:
            self._listed_ns = now_ns
            self._context.start_job(lambda _report: self._list_nodes(), self._take_nodes)
        if now_ns - self._lit_ns > _LIGHT_EVERY_NS:
            self._lit_ns = now_ns
            self._look_at_light()
            taken = tuple(self._cameras[name] for name in self._active_names)
            self._offers, self._crowded = offers(taken, self._nodes, self._statuses)
        if self._ready:
            self._write_draft()

    def command(self, command: Command) -> None:
        assert isinstance(command, OfCamera)
        name = command.camera
        if name not in self._cameras:
            raise InputError(f"there is no camera {brief(name)}", "the page", "reload the page")
        match command:
            case LeaveOut():
                if self._active_names == [name]:
                    raise InputError("one camera must stay", name, "take another in first")
                self._left_out.add(name)
            case TakeIn():
                self._left_out.discard(name)
            case Name():
                self._call(name, command.name)
            case ChangeMode():
                self._change_mode(name, command.size_px, command.fps_hz)
            case Lock():
                self._locking[name].again()

    def job_failed(self, error: MocapdError) -> None:
        """See Step. Only the list of nodes is a job; the cameras in use do not depend on it."""
        self._list_trouble = (Problem.of(error),)

    def view(self) -> StepView:
        taken = self._active_names
        problems = [problem for name in taken for problem in self._problems(name)]
        problems += (*self._crowded, *self._list_trouble)
        too_few = too_few_cameras(self._context.draft, len(taken))
        if too_few is not None:
            problems.append(too_few)
        share = sum(self._locking[name].share for name in taken) / len(taken)
        missing = [name for name in taken if self._is_gone(name)]
        if self._ready and too_few is not None:
            state = StepState.WAITING
            sentence = "One camera is ready: add a second one, or say that you have the shirt."
        elif self._ready:
            state, sentence = StepState.DONE, self._done_sentence(bool(problems))
        elif missing:
            state = StepState.WAITING
            sentence = (
                f"No picture from {' and '.join(self._label(name) for name in missing)}: see why "
                "below, mend it, or leave it out."
            )
        else:
            state = StepState.WORKING
            sentence = "Point the cameras at the play area and wait while they settle."
        return StepView(
            state,
            sentence,
            1.0 if self._ready else min(share, 0.99),
            tuple(problems),
            details={
                "cameras": [self._row(camera) for camera in self._cameras.values()],
                "others": [
                    _node_row(node)
                    for node in unused_nodes(tuple(self._cameras.values()), self._nodes)
                ],
            },
        )

    # -- the cameras -----------------------------------------------------------------------------

    @property
    def _active_names(self) -> list[str]:
        return [name for name in self._cameras if name not in self._left_out]

    @property
    def _ready(self) -> bool:
        return all(
            self._is_live(name) and self._locking[name].phase is LockPhase.LOCKED
            for name in self._active_names
        )

    def _is_live(self, name: str) -> bool:
        status = self._statuses.get(name)
        return status is not None and status.state is CaptureState.LIVE

    def _is_gone(self, name: str) -> bool:
        status = self._statuses.get(name)
        return status is not None and status.state in (CaptureState.LOST, CaptureState.ENDED)

    def _new_locking(self, camera: DraftCamera) -> CameraLocking:
        return CameraLocking(camera.id, camera.fps_hz, camera.controls, self._locks, self._watch)

    def _call(self, name: str, label: str) -> None:
        label = label.strip()
        if not label.isprintable():
            raise InputError(Name.refused, name, Name.fix)
        others = (self._label(other) for other in self._cameras if other != name)
        if label and label in others:
            raise InputError(f"another camera is called {label!r}", name, "take another name")
        self._cameras[name] = replace(self._cameras[name], label=label)

    def _change_mode(self, name: str, size_px: tuple[int, int], fps_hz: float) -> None:
        camera = self._cameras[name]
        node = node_of(camera, self._nodes)
        formats = node.formats if node is not None else ()
        there = any(fmt.size_px == size_px and fps_hz in fmt.rates_hz for fmt in formats)
        if not there or not self._locks.can_lock(name):
            raise InputError(
                f"has no mode {size_px[0]}x{size_px[1]} at {fps_hz:g} Hz",
                name,
                "take one that is offered",
            )
        self._locks.change_mode(name, size_px, fps_hz)
        self._cameras[name] = replace(camera, size_px=size_px, fps_hz=fps_hz)
        self._locking[name] = self._new_locking(self._cameras[name])

    def _take_nodes(self, nodes: tuple[CameraInfo, ...]) -> None:
        self._nodes, self._list_trouble = nodes, ()

    def _look_at_light(self) -> None:
        for name in self._active_names:
            frame, locking = self._context.hub.newest(name), self._locking[name]
            if frame is None or locking.phase is not LockPhase.LOCKED or not self._is_live(name):
                self._light.pop(name, None)
                continue
            light = light_problems(name, frame.pixels, locking.flicker, locking.exposure_s)
            self._light[name] = tuple(light)

    def _write_draft(self) -> None:
        cameras = tuple(
            replace(self._cameras[name], controls=self._locking[name].controls)
            for name in self._active_names
        )
        self._context.draft = with_cameras(self._context.draft, cameras)

    # -- what is shown ---------------------------------------------------------------------------

    def _label(self, name: str) -> str:
        return self._cameras[name].label or name

    def _problems(self, name: str) -> Sequence[Problem]:
        status = self._statuses.get(name)
        if status is not None and self._is_gone(name):
            what, _, fix = status.reason.partition(" -- ")
            return (Problem(what, name, fix),)
        slow: tuple[Problem, ...] = ()
        camera = self._cameras[name]
        if (
            self._locking[name].phase is LockPhase.LOCKED
            and status is not None
            and 0.0 < status.fps_hz < _ENOUGH_RATE * camera.fps_hz
        ):
            slow = (self._delivery_problem(camera, status.fps_hz),)
        return (*self._locking[name].trouble, *self._light.get(name, ()), *slow)

    def _delivery_problem(self, camera: DraftCamera, rate_hz: float) -> Problem:
        """Of a camera that is too slow, judged as in the step Check."""
        recent = self._watch.recent(camera.id)
        if len(recent.t_ns):
            recent = recent.since(int(recent.t_ns[-1]) - _JUDGED_NS)
        counts = recent.counts(camera.fps_hz)
        delivery = camera_delivery(camera, counts, rate_hz, self._machine.slow)
        worst = min(delivery_judgements(delivery), key=lambda entry: entry[0] is Grade.GOOD)
        return Problem(worst[1], camera.id, worst[2])

    def _done_sentence(self, has_problems: bool) -> str:
        count = len(self._active_names)
        if count == 1:
            return (
                "One camera is ready: it tracks, but how far away a hand is stays a guess. Go on, or "
                "add a second camera and start again."
            )
        rest = "Go on, or see first to what is said below." if has_problems else "Go on."
        return f"{count} cameras are ready and locked. {rest}"

    def _row(self, camera: DraftCamera) -> Json:
        name = camera.id
        status, locking = self._statuses.get(name), self._locking[name]
        offer = self._offers.get(name)
        held = {key: value for key, value in asdict(locking.controls).items() if value is not None}
        return {
            "id": name,
            "label": camera.label,
            "source": without_password(camera.source),
            "size_px": list(camera.size_px),
            "fps_hz": camera.fps_hz,
            "measured_hz": round(status.fps_hz, 1) if status is not None else 0.0,
            "taken": name not in self._left_out,
            "phase": "lost" if self._is_gone(name) else locking.phase.value,
            "share": round(locking.share, 2),
            "lockable": self._locks.can_lock(name),
            "controls": held if locking.phase is LockPhase.LOCKED else {},
            "problems": [asdict(problem) for problem in self._problems(name)]
            if name not in self._left_out
            else [],
            "offer": {"size_px": list(offer.size_px), "fps_hz": offer.fps_hz} if offer else None,
        }


def _node_row(one: CameraInfo) -> Json:
    return {
        "node": str(one.node) if one.node else "",
        "name": one.name,
        "source": without_password(one.spec),
        "problem": one.problem,
        "fix": one.fix,
        "note": one.note or ("" if one.problem else "not in use: start the setup again to use it"),
    }
