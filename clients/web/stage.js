// Floor, light and camera. What a game would replace first.

import { OrbitControls } from "./vendor/three/OrbitControls.js";
import * as THREE from "./vendor/three/three.module.min.js";

const FOLLOW_PER_S = 2; // how quickly the view goes after the person
const EYE_M = [0.9, 1.7, 3.6];
const MIDDLE_M = 1.0; // height that is looked at
const STILL_M = 1e-4; // a step of the view that nobody sees
const SLOW_MS = 45; // from picture to picture, on average; then it is drawn more plainly
const JUDGED_OF = 12; // pictures
const PLAIN = { pixels: 0.6, everyMs: 60 }; // leaves a machine without a graphics card something for mocapd itself
const SOFTWARE = /swiftshader|llvmpipe|software|basic render/i;

export class Stage {
  // full: draw everything, however slowly; else a slow machine gets no shadows, and fewer pixels and pictures. Throws
  // an Error where the browser has no WebGL.
  constructor(canvas, full = false) {
    this.full = full;
    this.plain = !full && isDrawnBySoftware();
    this.drawnMs = 0;
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: !this.plain });
    this.renderer.shadowMap.enabled = !this.plain;
    this.scene = new THREE.Scene();
    this.scene.background = new THREE.Color(0x11161d);
    this.scene.fog = new THREE.Fog(0x11161d, 7, 14);
    this.camera = new THREE.PerspectiveCamera(42, 1, 0.05, 40);
    this.camera.position.set(...EYE_M);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.target.set(0, MIDDLE_M, 0);
    this.controls.maxPolarAngle = Math.PI / 2; // never below the floor
    this.controls.addEventListener("change", () => this.touch());
    this.times = []; // of the last pictures that followed each other [ms]
    this.#furnish();
    addEventListener("resize", () => this.#fit());
    this.#fit();
  }

  // Goes after a point of the floor, `seconds` after the last time.
  follow({ x, z }, seconds) {
    const share = 1 - Math.exp(-FOLLOW_PER_S * seconds);
    const { target } = this.controls;
    const step = new THREE.Vector3(x - target.x, 0, z - target.z).multiplyScalar(share);
    if (step.length() < STILL_M) return;
    target.add(step);
    this.camera.position.add(step);
    this.touch();
  }

  // Something is to be seen anew.
  touch() {
    this.changed = true;
  }

  // Draws when something has changed: a picture that nothing has changed in costs nothing.
  draw(nowMs) {
    if (this.plain && nowMs - this.drawnMs < PLAIN.everyMs) return;
    this.controls.update();
    if (!this.changed) {
      this.times = [];
      return;
    }
    this.changed = false;
    this.drawnMs = nowMs;
    this.renderer.render(this.scene, this.camera);
    this.#judge(nowMs);
  }

  // A machine that is too slow for it draws plainly from then on.
  #judge(nowMs) {
    this.times.push(nowMs);
    if (this.full || this.plain || this.times.length <= JUDGED_OF) return;
    const everyMs = (nowMs - this.times.shift()) / JUDGED_OF;
    if (everyMs < SLOW_MS) return;
    this.plain = true;
    this.renderer.shadowMap.enabled = false;
    this.sun.castShadow = false;
    this.#fit();
  }

  #furnish() {
    const floor = new THREE.Mesh(
      new THREE.CircleGeometry(9, 64),
      new THREE.MeshStandardMaterial({ color: 0x1d2530, roughness: 0.95 }),
    );
    floor.rotation.x = -Math.PI / 2;
    floor.receiveShadow = true;
    const grid = new THREE.GridHelper(12, 12, 0x4a5a6c, 0x2b3644); // metres
    grid.position.y = 0.002;
    const sun = new THREE.DirectionalLight(0xffffff, 2.4);
    sun.position.set(2.5, 5, 3);
    sun.castShadow = !this.plain;
    sun.shadow.mapSize.set(1024, 1024);
    Object.assign(sun.shadow.camera, { left: -3, right: 3, top: 3, bottom: -3 });
    this.sun = sun;
    this.scene.add(floor, grid, sun, new THREE.HemisphereLight(0xbfd4ff, 0x30353c, 1.3));
  }

  #fit() {
    this.renderer.setPixelRatio(this.plain ? PLAIN.pixels : Math.min(devicePixelRatio, 2));
    this.renderer.setSize(innerWidth, innerHeight, false);
    this.camera.aspect = innerWidth / innerHeight;
    this.camera.updateProjectionMatrix();
    this.touch();
  }
}

// Whether the processor draws, as where there is no graphics card.
function isDrawnBySoftware() {
  const gl = document.createElement("canvas").getContext("webgl2");
  const told = gl?.getExtension("WEBGL_debug_renderer_info");
  const software = told ? SOFTWARE.test(gl.getParameter(told.UNMASKED_RENDERER_WEBGL)) : false;
  gl?.getExtension("WEBGL_lose_context")?.loseContext();
  return software;
}
