"""What a user's calibration of the simulated rig would give: cameras, stature, labelled pictures."""

from collections.abc import Mapping
from dataclasses import dataclass

from mocapd.types import LabelledPicture, Rig


@dataclass(frozen=True, slots=True, eq=False)
class SimSetup:
    """The rig, the stature the user typed in, per camera one labelled picture in the scenario's own
    light, and the labelled pictures of the shirt in neutral light."""

    rig: Rig
    stature_m: float
    scribbles: Mapping[str, LabelledPicture]
    model: tuple[LabelledPicture, ...]
