"""Facts of Python and the compiled libraries."""

import importlib
import platform
from importlib.metadata import PackageNotFoundError, version

from mocapd.config.sections import Config
from mocapd.doctor.facts import LibraryFacts
from mocapd.extras import has_extra, install_command
from mocapd.outputs.output_table import VRChatSection
from mocapd.outputs.vrchat.vrchat_sink import AUTO

# Modules with compiled code, which may be broken, and their packages.
_COMPILED = {
    "numpy": "numpy",
    "scipy": "scipy",
    "numba": "numba",
    "cv2": "opencv-python-headless",
    "zenoh": "eclipse-zenoh",
    "msgspec": "msgspec",
}


def library_facts(config: Config) -> LibraryFacts:
    """The facts; imports each library."""
    versions, broken = {}, {}
    for module, package in _COMPILED.items():
        try:
            importlib.import_module(module)
            versions[package] = version(package)
        except (ImportError, PackageNotFoundError) as error:
            broken[package] = str(error)
    section = config.outputs.get("vrchat")
    wants = isinstance(section, VRChatSection) and section.enabled and section.destination == AUTO
    fix = "" if has_extra("vrchat") else install_command("vrchat")
    return LibraryFacts(platform.python_version(), versions, broken, wants, fix)
