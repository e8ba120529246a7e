"""Builds what is handed on of the clients that are no Python: `python clients/pack.py DIST`.

mocapd-godot-VERSION.zip unpacks into a Godot project; dev.mocapd.unity-VERSION.tgz is what Unity's Package Manager installs
("Add package from tarball"); mocapd-web-VERSION.tar.gz is a folder to be served. The same sources give the same bytes.
"""

import gzip
import io
import json
import re
import sys
import tarfile
import zipfile
from collections.abc import Iterator
from pathlib import Path

CLIENTS = Path(__file__).resolve().parent
_DATE = (2026, 1, 1, 0, 0, 0)  # of every file in a zip
_LEFT_OUT = re.compile(r"(^|/)(\.|node_modules/|__pycache__/)")


def version() -> str:
    """That of mocapd."""
    text = (CLIENTS.parent / "mocapd" / "__init__.py").read_text(encoding="utf-8")
    found = re.search(r'__version__ = "([^"]+)"', text)
    assert found is not None
    return found.group(1)


def pack(folder: Path) -> list[Path]:
    """Write all of them there; their paths."""
    folder.mkdir(parents=True, exist_ok=True)
    return [pack_godot(folder), pack_unity(folder), pack_web(folder)]


def pack_godot(folder: Path) -> Path:
    """The add-on as Godot's asset library wants it: `addons/mocapd/` at the top."""
    path = folder / f"mocapd-godot-{version()}.zip"
    godot = CLIENTS / "godot"
    files = {f"addons/mocapd/{name}": data for name, data in _files(godot / "addons" / "mocapd")}
    files["addons/mocapd/README.md"] = (godot / "README.md").read_bytes()
    files["addons/mocapd/LICENSE"] = _licence()
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as made:
        for name, data in sorted(files.items()):
            made.writestr(zipfile.ZipInfo(name, _DATE), data, zipfile.ZIP_DEFLATED)
    return path


def pack_unity(folder: Path) -> Path:
    """As `npm pack` makes it, which Unity reads: everything below `package/`."""
    unity = CLIENTS / "unity"
    told = json.loads((unity / "package.json").read_text(encoding="utf-8"))
    path = folder / f"{told['name']}-{told['version']}.tgz"
    files = {f"package/{name}": data for name, data in _files(unity)}
    _write_tar(path, files)
    return path


def pack_web(folder: Path) -> Path:
    """The folder that a web server serves."""
    path = folder / f"mocapd-web-{version()}.tar.gz"
    top = path.name.removesuffix(".tar.gz")
    files = {f"{top}/{name}": data for name, data in _files(CLIENTS / "web")}
    files[f"{top}/LICENSE"] = _licence()
    _write_tar(path, files)
    return path


def _files(top: Path) -> Iterator[tuple[str, bytes]]:
    for path in sorted(top.rglob("*")):
        name = path.relative_to(top).as_posix()
        if path.is_file() and not _LEFT_OUT.search(name):
            yield name, path.read_bytes()


def _licence() -> bytes:
    return (CLIENTS.parent / "LICENSE").read_bytes()


def _write_tar(path: Path, files: dict[str, bytes]) -> None:
    raw = io.BytesIO()
    with tarfile.open(fileobj=raw, mode="w", format=tarfile.USTAR_FORMAT) as made:
        for name, data in sorted(files.items()):
            told = tarfile.TarInfo(name)
            told.size, told.mode = len(data), 0o644
            made.addfile(told, io.BytesIO(data))
    path.write_bytes(gzip.compress(raw.getvalue(), mtime=0))


if __name__ == "__main__":
    for made in pack(Path(sys.argv[1])):
        sys.stdout.write(f"{made}\n")
