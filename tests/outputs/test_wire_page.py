"""docs/wire.md says what the code does."""

import re

from mocapd.outputs.osc import osc_frame
from mocapd.outputs.zenoh import keys
from tests.outputs.wire_tables import PAGE, page_with_tables


def test_the_tables_are_those_of_the_structs() -> None:
    page = PAGE.read_text()
    assert page == page_with_tables(page), "run `python -m tests.outputs.wire_tables`"


def test_the_osc_tables_have_the_types_that_are_sent() -> None:
    for arguments, types in (
        (osc_frame.FRAME_ARGUMENTS, osc_frame.FRAME_TYPES),
        (osc_frame.JOINT_ARGUMENTS, osc_frame.JOINT_TYPES),
    ):
        assert "".join(kind for _, kind, _ in arguments) == types


def test_every_key_is_on_the_page() -> None:
    page = PAGE.read_text()
    for key in (
        keys.skeleton("<instance>", "<person>"),
        keys.health("<instance>"),
        "mocapd/v1/<instance>/camera/<id>/status",
        keys.calibration("<instance>"),
        keys.facing("<instance>", "<person>"),
        keys.schema("<instance>", "<name>"),
        keys.alive("<instance>"),
    ):
        assert f"`{key}`" in page


def test_the_python_examples_compile() -> None:
    examples = re.findall(r"```python\n(.*?)```", PAGE.read_text(), flags=re.DOTALL)
    assert examples
    for example in examples:
        compile(example, str(PAGE), "exec")
