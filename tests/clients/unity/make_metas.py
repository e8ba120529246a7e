"""Give every asset of the Unity package that has none a .meta file: `python -m tests.clients.unity.make_metas`.

Unity passes over assets without one in a package that it may not write into, as one from git is. The
identity is made of the path, once: it stays when the file moves on, or what refers to it is lost.
"""

import hashlib
from collections.abc import Iterator
from pathlib import Path

from tests.clients.unity.unity_player import PACKAGE


def assets() -> Iterator[Path]:
    """Files and folders that Unity imports; not those in folders ending in `~`."""
    for path in sorted(PACKAGE.rglob("*")):
        parts = path.relative_to(PACKAGE).parts
        if path.suffix != ".meta" and not any(part.endswith("~") for part in parts):
            yield path


def meta_of(asset: Path) -> Path:
    return asset.with_name(f"{asset.name}.meta")


def main() -> None:
    """Write those that are missing."""
    for asset in assets():
        if meta_of(asset).exists():
            continue
        name = f"mocapd/{asset.relative_to(PACKAGE).as_posix()}"
        guid = hashlib.md5(name.encode(), usedforsecurity=False).hexdigest()
        folder = "folderAsset: yes\n" if asset.is_dir() else ""
        meta_of(asset).write_text(f"fileFormatVersion: 2\nguid: {guid}\n{folder}")


if __name__ == "__main__":
    main()
