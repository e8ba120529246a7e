"""The map of ARCHITECTURE.md names every module that exists, with what its docstring says."""

from tests.architecture_map import PAGE, page_with_map


def test_the_map_is_what_the_modules_say() -> None:
    page = PAGE.read_text()
    assert page == page_with_map(page), "run: python -m tests.architecture_map"
