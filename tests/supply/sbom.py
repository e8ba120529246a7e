"""The bill of materials, CycloneDX 1.6 in JSON: what the runtime lock installs, and the libraries inside its wheels.

`make sbom` writes it to dist/, beside the wheel that it is for: it is made of locks/run.txt, of
bundled_libraries.py and of the installed packages' metadata, and of nothing else, so the same
checkout gives the same bytes. cyclonedx-bom would read the lock too, but knows neither licences nor what
wheels carry, and brings two dozen packages.
"""

import json
import sys
import tomllib
import uuid
from pathlib import Path
from typing import Any

from packaging.licenses import InvalidLicenseExpression, canonicalize_license_expression

import mocapd
from tests.supply.bundled_libraries import CARRIED, WORKS
from tests.supply.lock_files import PROJECT, ROOT, RUN, Pin, runtime_pins
from tests.supply.third_party_notices import licence_of

PLACE = ROOT / "dist" / f"mocapd-{mocapd.__version__}.cdx.json"


def bill() -> dict[str, Any]:
    """The whole document."""
    lock = f"mocapd {mocapd.__version__}\n{RUN.read_text()}"
    product = {
        "type": "application",
        "bom-ref": f"pkg:pypi/mocapd@{mocapd.__version__}",
        "name": "mocapd",
        "version": mocapd.__version__,
        "purl": f"pkg:pypi/mocapd@{mocapd.__version__}",
        "licenses": _licences(tomllib.loads(PROJECT.read_text())["project"]["license"]),
    }
    pins = runtime_pins()
    return {
        "$schema": "http://cyclonedx.org/schema/bom-1.6.schema.json",
        "bomFormat": "CycloneDX",
        "specVersion": "1.6",
        "serialNumber": f"urn:uuid:{uuid.uuid5(uuid.NAMESPACE_OID, lock)}",
        "version": 1,
        "metadata": {"component": product},
        "components": [_component(pin) for pin in pins],
        "dependencies": [{"ref": product["bom-ref"], "dependsOn": [purl(pin) for pin in pins]}],
    }


def purl(pin: Pin) -> str:
    """A package of PyPI as vulnerability databases name it."""
    return f"pkg:pypi/{pin.name}@{pin.version}"


def _component(pin: Pin) -> dict[str, Any]:
    hashes = sorted(text.removeprefix("sha256:") for text in pin.hashes)
    component: dict[str, Any] = {
        "type": "library",
        "bom-ref": purl(pin),
        "name": pin.name,
        "version": pin.version,
        "purl": purl(pin),
        "licenses": _licences(licence_of(pin.name)),
        # of each wheel that the lock accepts: a component's own `hashes` would be of one file
        "externalReferences": [
            {
                "type": "distribution",
                "url": f"https://pypi.org/project/{pin.name}/{pin.version}/",
                "hashes": [{"alg": "SHA-256", "content": text} for text in hashes],
            }
        ],
    }
    if pin.name in CARRIED:
        component["components"] = _carried(pin)
    return component


def _carried(pin: Pin) -> list[dict[str, Any]]:
    """Without versions: the wheels' file names do not tell them."""
    works = dict.fromkeys(WORKS[stem] for stem in CARRIED[pin.name])
    return [
        {
            "type": "library",
            "bom-ref": f"{purl(pin)}#{work}",
            "name": work,
            "licenses": _licences(licence),
        }
        for work, licence in works
    ]


def _licences(told: str) -> list[dict[str, Any]]:
    """An expression of SPDX, or by name, as older packages tell it."""
    try:
        return [{"expression": canonicalize_license_expression(told)}]
    except InvalidLicenseExpression:
        return [{"license": {"name": told}}]


def main() -> None:
    place = Path(sys.argv[1]) if len(sys.argv) > 1 else PLACE
    place.parent.mkdir(parents=True, exist_ok=True)
    place.write_text(json.dumps(bill(), indent=1) + "\n")
    print(place)


if __name__ == "__main__":
    main()
