"""Options of an export, and the motion prepared for a format."""

from dataclasses import dataclass, replace

from mocapd.errors import UsageError
from mocapd.exports.feet_on_floor import feet_on_floor
from mocapd.exports.formats import FORMATS
from mocapd.exports.sampled_motion import SampledMotion
from mocapd.exports.unseen_limbs import LIMBS, unseen_legs, visibility_text, without_joints
from mocapd.exports.up_axis import z_up


@dataclass(frozen=True, slots=True)
class ExportOptions:
    """is_z_up: +Z up in place of +Y; has_all_legs: also exports legs that no camera saw; are_feet_on_floor: see
    feet_on_floor."""

    is_z_up: bool = False
    has_all_legs: bool = False
    are_feet_on_floor: bool = False


def check_options(name: str, options: ExportOptions) -> None:
    """Raises UsageError for an option that the format does not have."""
    if options.is_z_up and not FORMATS[name].takes_z_up:
        raise UsageError(
            f"a file of {name} is +Y up by its format",
            "--up z",
            "leave it out: programs that have +Z up turn the file when they read it",
        )


def prepared_motion(
    motion: SampledMotion, name: str, options: ExportOptions
) -> tuple[SampledMotion, str]:
    """The motion for this format, and a remark for the user, perhaps empty. Raises UsageError."""
    check_options(name, options)
    remark = visibility_text(motion)
    unseen = () if options.has_all_legs else unseen_legs(motion)
    left_out = frozenset(bone for leg in unseen for bone in LIMBS[leg])
    if options.are_feet_on_floor:
        motion = feet_on_floor(motion)
    if left_out and FORMATS[name].keeps_all_joints:
        motion = replace(motion, unmoved=left_out)
        remark += f"; the {' and '.join(unseen)} do not move (--legs all moves them)"
    elif left_out:
        motion = without_joints(motion, left_out)
        remark += f"; left out: the {' and '.join(unseen)} (--legs all has them)"
    return (z_up(motion) if options.is_z_up else motion), remark
