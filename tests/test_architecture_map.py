"""docs/modules.md names every module that exists, with what its docstring says."""

from tests.architecture_map import PAGE, page


def test_the_map_is_what_the_modules_say() -> None:
    assert PAGE.read_text() == page(), "run: python -m tests.architecture_map"
