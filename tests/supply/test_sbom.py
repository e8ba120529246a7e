"""The bill of materials lists what the runtime locks list, by hash, and what its wheels carry."""

import json
from pathlib import Path
from typing import Any

import pytest

import mocapd
from tests.supply import sbom
from tests.supply.bundled_libraries import CARRIED, WORKS
from tests.supply.lock_files import runtime_pins


@pytest.fixture
def written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    place = tmp_path / "dist" / "some.cdx.json"
    monkeypatch.setattr("sys.argv", ["sbom", str(place)])
    sbom.main()
    found: dict[str, Any] = json.loads(place.read_text())
    return found


def test_it_lists_each_package_of_the_locks_with_version_and_hashes(
    written: dict[str, Any],
) -> None:
    listed = {
        (one["name"], one["version"]): {
            f"sha256:{digest['content']}"
            for reference in one["externalReferences"]
            for digest in reference["hashes"]
        }
        for one in written["components"]
    }
    locked = {(pin.name, pin.version): set(pin.hashes) for pin in runtime_pins()}
    assert listed == locked
    assert len(written["components"]) == len(locked)


def test_it_lists_the_libraries_inside_the_wheels(written: dict[str, Any]) -> None:
    listed = {
        one["name"]: {part["name"] for part in one["components"]}
        for one in written["components"]
        if "components" in one
    }
    assert listed == {wheel: {WORKS[stem][0] for stem in stems} for wheel, stems in CARRIED.items()}


def test_it_is_of_this_version_and_each_reference_is_of_one_thing(written: dict[str, Any]) -> None:
    product = written["metadata"]["component"]
    assert product["version"] == mocapd.__version__
    assert product["licenses"] == [{"expression": "Apache-2.0"}]
    parts = [part for one in written["components"] for part in one.get("components", [])]
    references = [one["bom-ref"] for one in (product, *written["components"], *parts)]
    assert len(set(references)) == len(references)
    (tree,) = written["dependencies"]
    assert tree["ref"] == product["bom-ref"]
    assert set(tree["dependsOn"]) <= set(references)


def test_the_same_checkout_gives_the_same_bill(written: dict[str, Any]) -> None:
    assert sbom.bill() == written
