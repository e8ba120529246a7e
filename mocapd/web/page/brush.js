// A picture to draw strokes on: mouse, pen, fingers and keys; zoom and pan.
//
// new BrushCanvas(name, size, tool, {onStart, onDone}): `tool` is shared by all canvases of the page,
// {id: 0..10, radius: px of a picture 640 wide}; onDone() when the pen is lifted after a change.

import { element } from "./setup.js";
import { Strokes } from "./strokes.js";

const MOST_ZOOM = 6;
const KEYS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

export class BrushCanvas {
  constructor(name, [width, height], colours, tool, { onStart, onDone }) {
    this.width = width;
    this.height = height;
    this.tool = tool;
    this.onStart = onStart;
    this.onDone = onDone;
    this.strokes = new Strokes(width, height, colours);
    this.picture = null;
    this.showStrokes = true;
    this.marks = [];
    this.outlines = [];
    this.zoom = 1;
    this.offset = [0, 0]; // of the picture's corner [canvas px]
    this.pointers = new Map();
    this.cursor = null; // [x, y] while the keys draw
    this.keyPen = false;
    this.canvas = element("canvas", {
      id: `canvas-${name}`,
      class: "brush-canvas",
      tabindex: "0",
      role: "application",
      "aria-label":
        `Strokes on the picture of ${name}. Arrow keys move the brush, space sets it down or lifts it, ` +
        "1 to 9 and 0 choose a colour, E erases.",
    });
    this.canvas.width = width;
    this.canvas.height = height;
    this.context = this.canvas.getContext("2d");
    for (const type of ["pointerdown", "pointermove", "pointerup", "pointercancel"]) {
      this.canvas.addEventListener(type, (event) => this[type](event));
    }
    this.canvas.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
    this.canvas.addEventListener("keydown", (event) => this.keydown(event));
    this.canvas.addEventListener("blur", () => this.lift());
  }

  /** Shows an image (anything that can be drawn) under the strokes. */
  show(picture, withStrokes) {
    this.picture = picture;
    this.showStrokes = withStrokes;
    this.render();
  }

  /** marks: [[x, y]] of strokes in trouble; outlines: [{name, at: [[x, y]]}] of what looks like the shirt. */
  remark(marks, outlines) {
    this.marks = marks;
    this.outlines = outlines;
    this.render();
  }

  get radius() {
    return (this.tool.radius * this.width) / 640;
  }

  render() {
    const { context, zoom } = this;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.fillStyle = "#000";
    context.fillRect(0, 0, this.canvas.width, this.canvas.height);
    context.setTransform(zoom, 0, 0, zoom, this.offset[0], this.offset[1]);
    context.imageSmoothingEnabled = zoom < 2;
    if (this.picture) context.drawImage(this.picture, 0, 0, this.width, this.height);
    if (this.showStrokes) context.drawImage(this.strokes.canvas, 0, 0);
    const unit = this.width / 640 / zoom;
    for (const outline of this.outlines) this.outline(outline, unit);
    for (const [x, y] of this.marks) this.ring(x, y, 12 * unit, "#fff", "#c00", unit);
    if (this.cursor) this.ring(...this.cursor, this.radius, "#fff", "#000", unit);
  }

  outline({ name, at }, unit) {
    const { context } = this;
    context.beginPath();
    for (const [x, y] of at) context.lineTo(x, y);
    context.closePath();
    this.twice("#ffd24a", "#000", unit, () => context.stroke());
    context.font = `${15 * unit}px system-ui, sans-serif`;
    context.lineWidth = 4 * unit;
    context.strokeStyle = "#000";
    context.fillStyle = "#ffd24a";
    context.strokeText(name, at[0][0], at[0][1]);
    context.fillText(name, at[0][0], at[0][1]);
  }

  ring(x, y, radius, inner, outer, unit) {
    this.context.beginPath();
    this.context.arc(x, y, radius, 0, 2 * Math.PI);
    this.twice(inner, outer, unit, () => this.context.stroke());
  }

  /** A line that is seen on any ground. */
  twice(inner, outer, unit, draw) {
    for (const [style, width] of [[outer, 4], [inner, 2]]) {
      this.context.strokeStyle = style;
      this.context.lineWidth = width * unit;
      draw();
    }
  }

  // -- places ------------------------------------------------------------------------------------

  /** Canvas px of an event. */
  at(event) {
    const box = this.canvas.getBoundingClientRect();
    return [
      ((event.clientX - box.left) * this.canvas.width) / box.width,
      ((event.clientY - box.top) * this.canvas.height) / box.height,
    ];
  }

  /** Picture px of canvas px. */
  inPicture([x, y]) {
    return [(x - this.offset[0]) / this.zoom, (y - this.offset[1]) / this.zoom];
  }

  /** Zoom by a factor about a place of the canvas, its middle unless told. */
  zoomBy(factor, about = [this.canvas.width / 2, this.canvas.height / 2]) {
    const zoom = Math.min(MOST_ZOOM, Math.max(1, this.zoom * factor));
    const [x, y] = this.inPicture(about);
    this.zoom = zoom;
    this.panTo([about[0] - x * zoom, about[1] - y * zoom]);
  }

  panTo([x, y]) {
    const room = [this.canvas.width * (1 - this.zoom), this.canvas.height * (1 - this.zoom)];
    this.offset = [Math.min(0, Math.max(room[0], x)), Math.min(0, Math.max(room[1], y))];
    this.render();
  }

  // -- mouse, pen, fingers -----------------------------------------------------------------------

  pointerdown(event) {
    this.canvas.setPointerCapture(event.pointerId);
    this.pointers.set(event.pointerId, this.at(event));
    this.cursor = null;
    if (this.pointers.size === 2) {
      this.cancelLine(); // the first of two fingers had begun one
      return;
    }
    if (event.button === 0 && this.showStrokes) this.startLine(this.inPicture(this.at(event)));
    else if (event.button === 1) event.preventDefault();
  }

  pointermove(event) {
    const before = this.pointers.get(event.pointerId);
    if (!before) return;
    const now = this.at(event);
    this.pointers.set(event.pointerId, now);
    if (this.pointers.size === 2) this.pinch(event.pointerId, before, now);
    else if (this.last) {
      const all = event.getCoalescedEvents?.() ?? [];
      for (const one of all.length ? all : [event]) this.lineTo(this.inPicture(this.at(one)));
    } else {
      this.panTo([this.offset[0] + now[0] - before[0], this.offset[1] + now[1] - before[1]]);
    }
  }

  pointerup(event) {
    this.pointers.delete(event.pointerId);
    this.endLine();
  }

  pointercancel(event) {
    this.pointers.delete(event.pointerId);
    this.cancelLine();
  }

  pinch(id, before, now) {
    const other = [...this.pointers].find(([key]) => key !== id)[1];
    const apart = (a) => Math.hypot(a[0] - other[0], a[1] - other[1]);
    const middle = [(now[0] + other[0]) / 2, (now[1] + other[1]) / 2];
    this.zoomBy(apart(now) / Math.max(1, apart(before)), middle);
    this.panTo([
      this.offset[0] + (now[0] - before[0]) / 2,
      this.offset[1] + (now[1] - before[1]) / 2,
    ]);
  }

  wheel(event) {
    event.preventDefault();
    this.zoomBy(Math.exp(-0.0015 * event.deltaY), this.at(event));
  }

  // -- lines -------------------------------------------------------------------------------------

  startLine(at) {
    this.onStart(this);
    this.strokes.begin();
    this.last = at;
    this.lineTo(at);
  }

  lineTo(at) {
    this.strokes.line(this.last, at, this.radius, this.tool.id);
    this.last = at;
    this.render();
  }

  endLine() {
    if (!this.last) return;
    this.last = null;
    this.onDone(this);
  }

  cancelLine() {
    if (!this.last) return;
    this.last = null;
    this.strokes.undo();
    this.render();
  }

  undo() {
    if (!this.strokes.undo()) return false;
    this.render();
    this.onDone(this);
    return true;
  }

  redo() {
    if (!this.strokes.redo()) return false;
    this.render();
    this.onDone(this);
    return true;
  }

  clear() {
    this.strokes.clear();
    this.render();
    this.onDone(this);
  }

  // -- keys --------------------------------------------------------------------------------------

  keydown(event) {
    const way = KEYS[event.key];
    if (way) {
      const step = Math.max(1, event.shiftKey ? 4 * this.radius : this.radius / 2);
      const from = this.cursor ?? [this.width / 2, this.height / 2];
      this.cursor = [
        Math.min(this.width - 1, Math.max(0, from[0] + step * way[0])),
        Math.min(this.height - 1, Math.max(0, from[1] + step * way[1])),
      ];
      if (this.keyPen) this.lineTo(this.cursor);
      this.render();
    } else if (event.key === " ") {
      this.cursor ??= [this.width / 2, this.height / 2];
      if (this.keyPen) this.lift();
      else if (this.showStrokes) {
        this.keyPen = true;
        this.startLine(this.cursor);
      }
    } else return;
    event.preventDefault();
  }

  lift() {
    if (!this.keyPen) return;
    this.keyPen = false;
    this.endLine();
  }
}
