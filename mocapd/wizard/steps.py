"""The steps of the setup, each by its name."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial

from mocapd.capture.webcam.listing import CameraInfo
from mocapd.pipeline.loop import OnDeath
from mocapd.wizard.body.body_step import BodyStep
from mocapd.wizard.cameras.camera_locks import CameraLocks
from mocapd.wizard.cameras.cameras_step import CamerasStep
from mocapd.wizard.cameras.same_port import AsksForPorts, PortChange
from mocapd.wizard.check.check_step import CheckStep
from mocapd.wizard.check.check_tracking import CheckSettings
from mocapd.wizard.colour.colour_step import ColourStep
from mocapd.wizard.draft import DraftCamera
from mocapd.wizard.extrinsics.extrinsics_step import ExtrinsicsStep
from mocapd.wizard.intrinsics.intrinsics_step import IntrinsicsStep
from mocapd.wizard.newest_body import NewestBody
from mocapd.wizard.step_names import StepName
from mocapd.wizard.wizard import MakeStep


@dataclass(frozen=True, slots=True)
class SetupCameras:
    """What the host has opened, in the order of the hub; nodes: lists the machine's cameras; moved: those
    found in another USB port than the saved calibration has them in, to be asked about."""

    opened: tuple[DraftCamera, ...]
    nodes: Callable[[], tuple[CameraInfo, ...]]
    locks: CameraLocks
    moved: tuple[PortChange, ...] = ()


def all_steps(
    cameras: SetupCameras, settings: CheckSettings, shown: NewestBody, died: OnDeath
) -> Mapping[StepName, MakeStep]:
    """What a Wizard is made of. `shown` gets the body that Check tracks; `died` hears of its pipeline's
    unexpected end."""
    choosing = partial(
        CamerasStep, cameras=cameras.opened, nodes=cameras.nodes, locks=cameras.locks
    )
    return {
        StepName.CAMERAS: partial(AsksForPorts, make=choosing, moved=list(cameras.moved)),
        StepName.LENS: IntrinsicsStep,
        StepName.ROOM: ExtrinsicsStep,
        StepName.COLOUR: ColourStep,
        StepName.BODY: BodyStep,
        StepName.CHECK: partial(CheckStep, settings=settings, shown=shown, died=died),
    }


def only(steps: Mapping[StepName, MakeStep], step: StepName) -> Mapping[StepName, MakeStep]:
    """The steps to do when one is to be done again: that one, and the check that saves it."""
    return {name: make for name, make in steps.items() if name in (step, StepName.CHECK)}
