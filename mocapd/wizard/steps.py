"""The steps of the setup, each by its name.

A step's module is imported on first use: together they take a second to import, and a page may never need them.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

from mocapd.capture.webcam.webcam_listing import CameraInfo
from mocapd.pipeline.loop import OnDeath
from mocapd.wizard.cameras.camera_locks import CameraLocks
from mocapd.wizard.cameras.same_port import AsksForPorts, PortChange
from mocapd.wizard.check.check_settings import CheckSettings
from mocapd.wizard.draft import DraftCamera
from mocapd.wizard.newest_body import NewestBody
from mocapd.wizard.step_names import StepName
from mocapd.wizard.wizard import MakeStep

if TYPE_CHECKING:
    from mocapd.wizard.context import Context, Step


@dataclass(frozen=True, slots=True)
class SetupCameras:
    """What the host has opened, in the order of the hub; nodes: lists the machine's cameras; moved: those
    in another USB port than in the saved calibration, for a question to the user."""

    opened: tuple[DraftCamera, ...]
    nodes: Callable[[], tuple[CameraInfo, ...]]
    locks: CameraLocks
    moved: tuple[PortChange, ...] = ()


def all_steps(
    cameras: SetupCameras, settings: CheckSettings, shown: NewestBody, died: OnDeath
) -> Mapping[StepName, MakeStep]:
    """All steps of a Wizard. `shown` gets the tracked body of Check; `died` gets an unexpected exception of
    its pipeline."""

    def choosing(context: "Context") -> "Step":
        from mocapd.wizard.cameras.cameras_step import CamerasStep

        return CamerasStep(context, cameras.opened, cameras.nodes, cameras.locks)

    def check(context: "Context") -> "Step":
        from mocapd.wizard.check.check_step import CheckStep

        return CheckStep(context, settings, shown, died)

    return {
        StepName.CAMERAS: partial(AsksForPorts, make=choosing, moved=list(cameras.moved)),
        StepName.LENS: _lens,
        StepName.ROOM: _room,
        StepName.COLOUR: _colour,
        StepName.BODY: _body,
        StepName.CHECK: check,
    }


def _lens(context: "Context") -> "Step":
    from mocapd.wizard.intrinsics.intrinsics_step import IntrinsicsStep

    return IntrinsicsStep(context)


def _room(context: "Context") -> "Step":
    from mocapd.wizard.extrinsics.extrinsics_step import ExtrinsicsStep

    return ExtrinsicsStep(context)


def _colour(context: "Context") -> "Step":
    from mocapd.wizard.colour.colour_step import ColourStep

    return ColourStep(context)


def _body(context: "Context") -> "Step":
    from mocapd.wizard.body.body_step import BodyStep

    return BodyStep(context)


def only(steps: Mapping[StepName, MakeStep], step: StepName) -> Mapping[StepName, MakeStep]:
    """The steps for repeating one: that one, and the check that saves it; after the lens the room, which a new lens makes
    invalid."""
    wanted = {step, StepName.CHECK} | ({StepName.ROOM} if step is StepName.LENS else set())
    return {name: make for name, make in steps.items() if name in wanted}
