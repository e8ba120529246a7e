"""What the step Body draws over the picture that it measured."""

from mocapd.body.skeleton import standard_skeleton
from mocapd.wizard.body.measured_body import measured_bones


def test_no_leg_is_drawn_that_nobody_measured() -> None:
    skeleton = standard_skeleton(1.75)
    drawn = {skeleton.names[child] for _, child in measured_bones(skeleton)}
    assert {"chest", "leftLowerArm", "rightHand", "head"} <= drawn
    assert not {name for name in drawn if "Leg" in name or "Foot" in name or "Toes" in name}
