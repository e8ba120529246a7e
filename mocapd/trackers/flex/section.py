"""What a user may set of the tracker without a shirt; its other numbers are in `params`."""

from dataclasses import dataclass
from typing import Annotated

from msgspec import Meta


@dataclass(frozen=True, slots=True)
class FlexSection:
    """What is believed, and which steps are taken.

    live_explained: share of the drawn body and of what stands there that agree, for the pose to be believed
    accept_explained: the same of a silhouette that is taken for a person
    joints: a network tells where in each picture the joints are
    texture: before cameras side by side, distances are measured by the cloth's texture
    depths: before such cameras, limbs are looked for where something is seen before the body
    floor: feet stand on the floor and are not under it
    arm_search: other poses are tried for an arm that does not agree with the pictures
    leg_search: the same for a leg, and legs that stay crossed are exchanged
    faces: a face that shows where somebody is thought to look away turns them round
    turns: now and then the body is tried turned round
    shadows: shadows are told from people
    look_alikes: regions of the body that look alike are one
    limits: joints have limits, and arms do not enter the trunk
    steady: what the pictures hardly confirm is told to move slowly
    """

    live_explained: Annotated[float, Meta(gt=0.0, lt=1.0)] = 0.45
    accept_explained: Annotated[float, Meta(gt=0.0, lt=1.0)] = 0.75
    joints: bool = True
    texture: bool = True
    depths: bool = True
    floor: bool = True
    arm_search: bool = True
    leg_search: bool = True
    faces: bool = True
    turns: bool = True
    shadows: bool = True
    look_alikes: bool = True
    limits: bool = True
    steady: bool = True
