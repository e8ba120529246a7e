"""What the step Body draws over the picture that it measured."""

from pathlib import Path

from mocapd.body.skeleton import standard_skeleton
from mocapd.wizard.body.body_measuring import BodyWatch
from mocapd.wizard.body.body_step import OLDEST_NS, BodyStep
from mocapd.wizard.body.measured_body import measured_bones
from tests.outputs.frames import left_hand_up
from tests.wizard.context import FakeContext
from tests.wizard.drafts import full_draft


def test_no_leg_is_drawn_that_nobody_measured() -> None:
    skeleton = standard_skeleton(1.75)
    drawn = {skeleton.names[child] for _, child in measured_bones(skeleton)}
    assert {"chest", "leftLowerArm", "rightHand", "head"} <= drawn
    assert not {name for name in drawn if "Leg" in name or "Foot" in name or "Toes" in name}


def test_a_body_older_than_the_pictures_is_not_drawn_over_them(tmp_path: Path) -> None:
    body, skeleton = left_hand_up()
    context = FakeContext(tmp_path, full_draft())
    step = BodyStep(context)
    step._watched = BodyWatch((body, skeleton))
    step.tick(body.t_ns + OLDEST_NS)
    assert any(step.view().overlays.values())
    step.tick(body.t_ns + OLDEST_NS + 1)
    assert step.view().overlays == {}
