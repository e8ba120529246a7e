"""Shows a GLB of `mocapd export` in three.js and measures whether a figure is seen and moves:

    npm install --prefix FOLDER three@0.185.0
    python -m tests.browser.glb_in_three SESSION.glb FOLDER/node_modules/three PICTURES

Writes first.png and later.png there; exit code 1 where nothing is seen or nothing moves. three.js' loader is not
vendored, as the web client does without it: so this is no test of the suite.
"""

import argparse
import shutil
import sys
import tempfile
import threading
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import cv2
import numpy as np
from playwright.sync_api import sync_playwright

_SIZE_PX = (640, 480)
_SHARE = 0.002  # of the picture, that at least must be a figure, or move
_PAGE = """<!doctype html><meta charset="utf-8"><style>body { margin: 0 }</style>
<script type="importmap">
{"imports": {"three": "./three/build/three.module.js", "three/addons/": "./three/examples/jsm/"}}
</script>
<script type="module">
import * as THREE from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
const renderer = new THREE.WebGLRenderer({ preserveDrawingBuffer: true });
renderer.setSize(640, 480);
document.body.append(renderer.domElement);
const scene = new THREE.Scene();
scene.background = new THREE.Color(0xffffff);
scene.add(new THREE.HemisphereLight(0xffffff, 0x666666, 3));
const camera = new THREE.PerspectiveCamera(45, 640 / 480, 0.1, 50);
camera.position.set(0, 1.2, 4.5);
camera.lookAt(0, 1, 0);
const file = await new GLTFLoader().loadAsync("session.glb");
scene.add(file.scene);
const mixer = new THREE.AnimationMixer(file.scene);
mixer.clipAction(file.animations[0]).play();
window.at = (share) => {
  mixer.setTime(share * file.animations[0].duration);
  renderer.render(scene, camera);
};
window.at(0);
document.title = "ready";
</script>"""


class _Files(SimpleHTTPRequestHandler):
    def log_message(self, *_: object) -> None:
        """Nothing."""


def pictures(glb: Path, three: Path, out: Path) -> list[Path]:
    """At the beginning and after two fifths of the session."""
    out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="mocapd-three-") as folder:
        Path(folder, "index.html").write_text(_PAGE, encoding="utf-8")
        Path(folder, "three").symlink_to(three.resolve())
        shutil.copy(glb, Path(folder, "session.glb"))
        handler = partial(_Files, directory=folder)
        with ThreadingHTTPServer(("127.0.0.1", 0), handler) as server, sync_playwright() as driver:
            threading.Thread(target=server.serve_forever, daemon=True).start()
            browser = driver.chromium.launch(
                executable_path=shutil.which("chromium"), args=["--no-sandbox"]
            )
            page = browser.new_page(viewport={"width": _SIZE_PX[0], "height": _SIZE_PX[1]})
            page.set_default_timeout(240_000)
            page.goto(f"http://127.0.0.1:{server.server_port}/index.html")
            page.wait_for_function("document.title === 'ready'")
            written = []
            for name, share in (("first", 0.0), ("later", 0.4)):
                page.evaluate("share => window.at(share)", share)
                written.append(out / f"{name}.png")
                page.screenshot(path=written[-1])
            browser.close()
            server.shutdown()
    return written


def main() -> int:
    """The exit code."""
    parser = argparse.ArgumentParser(description="shows a GLB in three.js")
    for name in ("glb", "three", "out"):
        parser.add_argument(name, type=Path)
    options = parser.parse_args()
    paths = pictures(options.glb, options.three, options.out)
    first, later = (np.asarray(cv2.imread(str(path))).astype(int) for path in paths)
    seen = float((np.abs(first - 255).max(axis=2) > 20).mean())
    moved = float((np.abs(first - later).max(axis=2) > 20).mean())
    print(
        f"{options.glb.name}: a figure on {100 * seen:.1f} % of the picture; {100 * moved:.1f} % changed"
    )
    return int(min(seen, moved) < _SHARE)


if __name__ == "__main__":
    sys.exit(main())
