"""`make check` fails on a circle of imports, a dead link and a class name that is there twice."""

from pathlib import Path

import pytest

from tests.code_structure import Structure, circles, structure_of

IMPORTS = {"mocapd.a.one": {"mocapd.b.two"}, "mocapd.b.two": set[str]()}


@pytest.fixture
def root(tmp_path: Path) -> Path:
    """A project of two rooms in which nothing is wrong."""
    for path, text in (
        ("mocapd/a/one.py", '"""See docs/page.md."""\n\n\nclass One:\n    pass\n'),
        ("mocapd/b/two.py", "class Two:\n    pass\n\n\nclass _Part:\n    pass\n"),
        ("docs/page.md", "[one](../mocapd/a/one.py), [elsewhere](https://example.org/none)\n"),
    ):
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / path).write_text(text)
    return tmp_path


def structure(root: Path) -> Structure:
    return structure_of(root, IMPORTS)


def test_nothing_is_wrong_and_rooms_are_counted(root: Path) -> None:
    found = structure(root)
    assert found.is_sound
    assert found.rooms == ("a 1 modules, 5 lines", "b 1 modules, 6 lines")
    assert "circles of imports: 0" in found.text()


def test_a_circle_fails(root: Path) -> None:
    found = structure_of(root, IMPORTS | {"mocapd.b.two": {"mocapd.a.one"}})
    assert found.circles == ("mocapd.a.one -> mocapd.b.two -> mocapd.a.one",)
    assert not found.is_sound


def test_each_circle_is_named_once_and_whoever_only_leads_there_is_none() -> None:
    imports = {"d": {"a"}, "a": {"b"}, "b": {"c"}, "c": {"a"}, "x": {"y", "a"}, "y": {"x"}}
    assert circles(imports) == [["a", "b", "c", "a"], ["x", "y", "x"]]


@pytest.mark.parametrize("page", ["docs/page.md", "mocapd/a/one.py"])
def test_a_dead_link_fails(root: Path, page: str) -> None:
    (root / page).write_text('"""[gone](gone.md), docs/gone.md"""\n')
    found = structure(root)
    assert [link.split(":")[0] for link in found.dead_links] == [page]
    assert not found.is_sound


def test_a_class_name_that_is_there_twice_fails(root: Path) -> None:
    (root / "mocapd/b/three.py").write_text("class One:\n    pass\n\n\nclass _Part:\n    pass\n")
    found = structure(root)
    assert found.classes_twice == ("One 2 times",)
    assert not found.is_sound


def test_module_names_twice_and_long_files_are_said_only(root: Path) -> None:
    (root / "mocapd/b/one.py").write_text("\n" * 351)
    found = structure(root)
    assert (found.modules_twice, found.long_files) == (
        ("one.py 2 times",),
        ("mocapd/b/one.py 351",),
    )
    assert found.is_sound
