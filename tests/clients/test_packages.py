"""What is handed on of the clients: each archive whole, as its receiver wants it, and the same each time."""

import json
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PACK = ROOT / "clients" / "pack.py"


def packed(folder: Path) -> dict[str, Path]:
    """By kind."""
    subprocess.run([sys.executable, PACK, folder], check=True, capture_output=True)
    kinds = {".zip": "godot", ".tgz": "unity", ".gz": "web"}
    return {kinds[path.suffix]: path for path in folder.iterdir()}


def test_each_archive_is_whole_and_the_same_each_time(tmp_path: Path) -> None:
    made, again = packed(tmp_path / "one"), packed(tmp_path / "two")
    for kind, path in made.items():
        assert path.read_bytes() == again[kind].read_bytes(), kind

    with zipfile.ZipFile(made["godot"]) as opened:
        names = set(opened.namelist())
        assert {"addons/mocapd/plugin.cfg", "addons/mocapd/LICENSE"} <= names
        assert all(name.startswith("addons/mocapd/") for name in names), "it unpacks into a project"
        script = opened.read("addons/mocapd/plugin.cfg").decode().partition('script="')[2]
        assert f"addons/mocapd/{script.partition(chr(34))[0]}" in names

    with tarfile.open(made["unity"]) as opened_tar:
        names = set(opened_tar.getnames())
        told = json.load(opened_tar.extractfile("package/package.json"))  # type: ignore[arg-type]
    assert made["unity"].name == f"{told['name']}-{told['version']}.tgz"
    assert all(name.startswith("package/") for name in names)
    # Unity asks for a .meta beside each asset, but below folders that end with ~
    assets = {n for n in names if "~/" not in n and not n.endswith(".meta") and n.count("/") > 1}
    assert {f"{name}.meta" for name in assets} <= names
    assert any(name.startswith("package/Samples~/") for name in names)

    with tarfile.open(made["web"]) as opened_tar:
        names = {name.partition("/")[2] for name in opened_tar.getnames()}
    assert {"index.html", "main.js", "vendor/three/three.module.min.js", "LICENSE"} <= names
    assert not any("node_modules" in name for name in names)
