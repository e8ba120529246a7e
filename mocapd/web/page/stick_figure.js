// The body in 3D on the floor of the play area, with the cameras. World: +Y up, metres.
// Framed on the body where there is one, else on the cameras. Turned by dragging (mouse, pen, one finger) and by the arrow keys; nearer by wheel, two fingers, + and -.

import { drawHalo } from "./halo.js";

const FLOOR_M = 2; // half of the grid
const LOOK_AT_M = [0, 0.9, 0]; // without a body
const BODY_DISTANCE_M = 3.4; // from which somebody who reaches up fills the picture
const DRIFT_M = 0.3; // so far from the middle of the picture a body may be
const FOLLOW = 0.08; // share of what it is farther, a picture
const FIELD_OF_VIEW = 0.75; // rad
const KEY_TURN = 0.12; // rad
const NEAREST_M = 1.5;
const FARTHEST_M = 20;
// as wizard/bone_shapes.py
const SURE = 0.35; // joints of less confidence are drawn as guesses, those of which nothing is known not at all
const WIDEST_M = 0.3; // of a halo: what is less certain is not known better for being drawn wider

export class StickFigure {
  constructor(root) {
    this.canvas = document.createElement("canvas");
    this.canvas.className = "stick-figure";
    this.canvas.tabIndex = 0;
    this.canvas.setAttribute("role", "img");
    this.canvas.setAttribute(
      "aria-label",
      "The body in 3D. Arrow keys turn it, plus and minus bring it nearer or farther.",
    );
    root.append(this.canvas);
    this.turn = 0.5; // rad about the vertical; 0 looks at the person's front
    this.tilt = 0.3; // rad above the horizon
    this.distance_m = 5.5;
    this.moved = false; // by a person
    this.scene = { cameras: [], parents: [] };
    this.body = null;
    this.centre_m = null; // what is looked at; null: no body yet
    this.pointers = new Map();
    for (const type of ["pointerdown", "pointermove", "pointerup", "pointercancel"]) {
      this.canvas.addEventListener(type, (event) => this.pointer(event));
    }
    this.canvas.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
    this.canvas.addEventListener("keydown", (event) => this.key(event));
    this.resized = new ResizeObserver(() => this.draw());
    this.resized.observe(this.canvas);
  }

  setScene(scene) {
    this.scene = scene;
    if (!this.moved && !this.centre_m) this.distance_m = this.distanceToSeeAll();
    this.draw();
  }

  /** So far away [m] that every camera is in the picture. */
  distanceToSeeAll() {
    const reach = this.scene.cameras.map(({ centre_m: c }) => Math.hypot(c[0], c[1] - LOOK_AT_M[1], c[2]));
    return Math.min(FARTHEST_M, Math.max(4.5, 2.4 * Math.max(0, ...reach)));
  }

  setBody(body) {
    this.body = body;
    if (body?.joints_m) this.follow(body.joints_m[0]);
    this.draw();
  }

  /** Keeps the hips near the middle of the picture; their height is that of somebody who stands. */
  follow([x, , z]) {
    if (!this.centre_m) {
      this.centre_m = [x, LOOK_AT_M[1], z];
      if (!this.moved) this.distance_m = BODY_DISTANCE_M;
      return;
    }
    const off = [x - this.centre_m[0], z - this.centre_m[2]];
    const share = FOLLOW * Math.max(0, 1 - DRIFT_M / Math.max(1e-6, Math.hypot(...off)));
    this.centre_m = [this.centre_m[0] + share * off[0], LOOK_AT_M[1], this.centre_m[2] + share * off[1]];
  }

  pointer(event) {
    if (event.type === "pointerdown") {
      this.canvas.setPointerCapture(event.pointerId);
      this.pointers.set(event.pointerId, event);
      return;
    }
    const before = this.pointers.get(event.pointerId);
    if (!before) return;
    if (event.type !== "pointermove") {
      this.pointers.delete(event.pointerId);
      return;
    }
    const others = [...this.pointers.values()].filter((one) => one.pointerId !== event.pointerId);
    this.pointers.set(event.pointerId, event);
    if (others.length > 0) {
      const from = apart(before, others[0]);
      if (from > 0) this.nearer(from / Math.max(1, apart(event, others[0])));
    } else {
      this.orbit((event.clientX - before.clientX) * -0.008, (event.clientY - before.clientY) * 0.008);
    }
  }

  wheel(event) {
    event.preventDefault();
    this.nearer(Math.exp(event.deltaY * 0.001));
  }

  key(event) {
    const turns = {
      ArrowLeft: [KEY_TURN, 0],
      ArrowRight: [-KEY_TURN, 0],
      ArrowUp: [0, KEY_TURN],
      ArrowDown: [0, -KEY_TURN],
    };
    if (turns[event.key]) this.orbit(...turns[event.key]);
    else if (event.key === "+" || event.key === "=") this.nearer(1 / 1.15);
    else if (event.key === "-") this.nearer(1.15);
    else return;
    event.preventDefault();
  }

  orbit(turn, tilt) {
    this.turn += turn;
    this.tilt = Math.min(1.5, Math.max(-0.1, this.tilt + tilt));
    this.draw();
  }

  nearer(factor) {
    this.moved = true;
    this.distance_m = Math.min(FARTHEST_M, Math.max(NEAREST_M, this.distance_m * factor));
    this.draw();
  }

  draw() {
    const unit = window.devicePixelRatio || 1;
    const width = Math.round(this.canvas.clientWidth * unit);
    const height = Math.round(this.canvas.clientHeight * unit);
    if (width === 0 || height === 0) return;
    if (this.canvas.width !== width) this.canvas.width = width;
    if (this.canvas.height !== height) this.canvas.height = height;
    const context = this.canvas.getContext("2d");
    context.clearRect(0, 0, width, height);
    context.lineCap = "round";
    const css = getComputedStyle(this.canvas);
    const colour = (name) => css.getPropertyValue(`--${name}`).trim();
    const pen = { context, unit, see: this.eye(width, height) };
    drawFloor(pen, colour("line"));
    if (this.centre_m) drawScale(pen, this.centre_m, colour("text-soft"));
    for (const camera of this.scene.cameras) drawCamera(pen, camera, colour("text-soft"));
    if (this.body?.joints_m) drawBody(pen, this.body, this.scene.parents, colour);
  }

  /** From world points [m] to canvas pixels; null before the eye's near plane. */
  eye(width, height) {
    const focal = height / 2 / Math.tan(FIELD_OF_VIEW / 2);
    const [cosTurn, sinTurn] = [Math.cos(this.turn), Math.sin(this.turn)];
    const [cosTilt, sinTilt] = [Math.cos(this.tilt), Math.sin(this.tilt)];
    const at_m = this.centre_m ?? LOOK_AT_M;
    return ([px, py, pz]) => {
      const [x, y, z] = [px - at_m[0], py - at_m[1], pz - at_m[2]];
      const right = x * cosTurn - z * sinTurn;
      const towards = x * sinTurn + z * cosTurn;
      const up = y * cosTilt - towards * sinTilt;
      const depth = this.distance_m - (y * sinTilt + towards * cosTilt);
      if (depth < 0.05) return null;
      return [width / 2 + (right * focal) / depth, height / 2 - (up * focal) / depth, focal / depth];
    };
  }

  destroy() {
    this.resized.disconnect();
    this.canvas.remove();
  }
}

function apart(one, other) {
  return Math.hypot(one.clientX - other.clientX, one.clientY - other.clientY);
}

function drawFloor(pen, colour) {
  for (let i = -FLOOR_M; i <= FLOOR_M; i += 0.5) {
    const width = i === 0 ? 2 : 1;
    // in pieces, so that one end behind the eye does not take the whole line away
    for (let j = -FLOOR_M; j < FLOOR_M; j += 0.5) {
      line(pen, [i, 0, j], [i, 0, j + 0.5], colour, width);
      line(pen, [j, 0, i], [j + 0.5, 0, i], colour, width);
    }
  }
}

function drawCamera(pen, camera, colour) {
  camera.corners_m.forEach((corner, i) => {
    line(pen, camera.centre_m, corner, colour, 1.5);
    line(pen, corner, camera.corners_m[(i + 1) % 4], colour, 1.5);
  });
  const ends = [camera.centre_m, ...camera.corners_m].map(pen.see);
  if (ends.includes(null)) return;
  const [left, right] = [Math.min, Math.max].map((which) => which(...ends.map(([x]) => x)));
  label(pen, camera.name, (left + right) / 2, Math.min(...ends.map(([, y]) => y)), colour);
}

/** A metre on the floor before the body. */
function drawScale(pen, [x, , z], colour) {
  const [from, to] = [[x - 0.5, 0, z + 0.7], [x + 0.5, 0, z + 0.7]];
  line(pen, from, to, colour, 3);
  for (const [end_x, , end_z] of [from, to]) line(pen, [end_x, 0, end_z - 0.05], [end_x, 0, end_z + 0.05], colour, 3);
  const at = pen.see([x, 0, z + 0.82]);
  if (at) label(pen, "1 m", at[0], at[1] + 16 * pen.unit, colour);
}

/** A text whose bottom is above a place. */
function label(pen, text, x, y, colour) {
  pen.context.fillStyle = colour;
  pen.context.font = `600 ${13 * pen.unit}px system-ui, sans-serif`;
  pen.context.textAlign = "left";
  const across = pen.context.measureText(text).width;
  const left = Math.min(Math.max(4 * pen.unit, x - across / 2), pen.context.canvas.width - across - 4 * pen.unit);
  pen.context.fillText(text, left, y - 6 * pen.unit);
}

function drawBody(pen, body, parents, colour) {
  const [bone, hint] = [colour("shape-bone"), colour("shape-hint")];
  const sure = body.tracking === "live" ? bone : hint;
  const isKnown = (i) => body.confidence[i] > 0 || Number.isFinite(body.uncertainty_m[i]);
  const lookOf = (i) => (body.confidence[i] >= SURE ? sure : hint);
  const bones = parents.flatMap((parent, i) => (parent >= 0 && isKnown(i) && isKnown(parent) ? [[parent, i]] : []));
  body.joints_m.forEach(([x, , z], i) => {
    if (isKnown(i)) line(pen, [x, 0, z], [x, 0, z], colour("line"), 6); // its shadow
  });
  for (const look of new Set([hint, sure])) {
    const ends = bones.filter(([, i]) => lookOf(i) === look).map((both) => both.map((i) => blurred(pen, body, i)));
    drawHalo(pen.context, ends.filter(([from, to]) => from && to), look);
  }
  for (const [parent, i] of bones) {
    const guessed = body.confidence[i] < SURE;
    line(pen, body.joints_m[parent], body.joints_m[i], lookOf(i), guessed ? 2.5 : 5, guessed ? [4, 7] : []);
  }
  const top = parents.length > 5 ? 5 : 0; // VRM order: the head is the sixth
  const [x, y, z] = body.joints_m[top];
  const at = pen.see([x, y + 0.09, z]);
  if (!at || !isKnown(top)) return;
  pen.context.strokeStyle = lookOf(top);
  pen.context.lineWidth = 4 * pen.unit;
  pen.context.beginPath();
  pen.context.arc(at[0], at[1], 0.1 * at[2], 0, 2 * Math.PI);
  pen.context.stroke();
}

/** A joint on the canvas, with its uncertainty as a radius there; null before the eye's near plane. */
function blurred(pen, body, i) {
  const at = pen.see(body.joints_m[i]);
  return at && [at[0], at[1], Math.min(body.uncertainty_m[i] ?? 0, WIDEST_M) * at[2]];
}

function line(pen, from, to, colour, width, dashes = []) {
  const [a, b] = [pen.see(from), pen.see(to)];
  if (!a || !b) return;
  pen.context.strokeStyle = colour;
  pen.context.lineWidth = width * pen.unit;
  pen.context.setLineDash(dashes.map((length) => length * pen.unit));
  pen.context.beginPath();
  pen.context.moveTo(a[0], a[1]);
  pen.context.lineTo(b[0], b[1]);
  pen.context.stroke();
  pen.context.setLineDash([]);
}
