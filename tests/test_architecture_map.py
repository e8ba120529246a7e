"""Every module and folder opens by saying what is there, each in words of its own."""

from collections import Counter

from tests.architecture_map import first_lines, text


def test_every_module_says_what_it_is_in_one_line_of_its_own() -> None:
    lines = first_lines()
    assert not [path for path, first in lines.items() if not first]
    twice = [line for line, count in Counter(lines.values()).items() if count > 1]
    assert not twice


def test_the_map_has_them_all() -> None:
    lines = first_lines()
    assert len([line for line in text().splitlines() if line]) == len(lines)
