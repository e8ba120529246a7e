// The strokes on one picture: colour ids 0..10 of each pixel, with undo, and as coloured pixels.

const MOST_UNDO = 30;
const STRIPE = 9; // a stroke is striped, or it would not be seen on the patch that it is right for

/** Ids of a picture of width x height. */
export class Strokes {
  /** colours: [{id, rgb}] */
  constructor(width, height, colours) {
    this.width = width;
    this.height = height;
    this.ids = new Uint8Array(width * height);
    this.done = []; // ids before each change
    this.undone = [];
    this.unit = Math.max(1, Math.round(width / 480));
    this.rgb = new Map(colours.map((one) => [one.id, one.rgb]));
    this.canvas = document.createElement("canvas");
    this.canvas.width = width;
    this.canvas.height = height;
    this.context = this.canvas.getContext("2d");
  }

  /** Remember the strokes as they are, before they change. */
  begin() {
    this.done.push(this.ids.slice());
    if (this.done.length > MOST_UNDO) this.done.shift();
    this.undone = [];
  }

  /** Whether there was something to undo. */
  undo() {
    return this.swap(this.done, this.undone);
  }

  redo() {
    return this.swap(this.undone, this.done);
  }

  swap(from, to) {
    const ids = from.pop();
    if (!ids) return false;
    to.push(this.ids);
    this.ids = ids;
    this.paint(0, 0, this.width, this.height);
    return true;
  }

  /** All strokes anew; can be undone. */
  replace(ids) {
    this.begin();
    this.ids = ids.slice();
    this.paint(0, 0, this.width, this.height);
  }

  clear() {
    this.replace(new Uint8Array(this.width * this.height));
  }

  /** A thick line from a to b ([x, y] px), round at its ends; id 0 erases. */
  line(a, b, radius, id) {
    const length = Math.hypot(b[0] - a[0], b[1] - a[1]);
    const steps = Math.max(1, Math.ceil(length / Math.max(1, radius / 2)));
    for (let i = 0; i <= steps; i++) {
      const along = i / steps;
      this.dot(a[0] + along * (b[0] - a[0]), a[1] + along * (b[1] - a[1]), radius, id);
    }
    const left = Math.floor(Math.min(a[0], b[0]) - radius - 1);
    const top = Math.floor(Math.min(a[1], b[1]) - radius - 1);
    const right = Math.ceil(Math.max(a[0], b[0]) + radius + 1);
    const bottom = Math.ceil(Math.max(a[1], b[1]) + radius + 1);
    this.paint(left, top, right, bottom);
  }

  dot(x, y, radius, id) {
    const top = Math.max(0, Math.ceil(y - radius));
    const bottom = Math.min(this.height - 1, Math.floor(y + radius));
    for (let row = top; row <= bottom; row++) {
      const half = Math.sqrt(Math.max(0, radius * radius - (row - y) * (row - y)));
      const left = Math.max(0, Math.ceil(x - half));
      const right = Math.min(this.width - 1, Math.floor(x + half));
      if (right >= left) this.ids.fill(id, row * this.width + left, row * this.width + right + 1);
    }
  }

  /** Bring the coloured pixels of a region up to date. */
  paint(left, top, right, bottom) {
    const x0 = Math.max(0, left);
    const y0 = Math.max(0, top);
    const x1 = Math.min(this.width, right);
    const y1 = Math.min(this.height, bottom);
    if (x1 <= x0 || y1 <= y0) return;
    const image = this.context.createImageData(x1 - x0, y1 - y0);
    const stripe = STRIPE * this.unit;
    for (let y = y0, at = 0; y < y1; y++) {
      for (let x = x0; x < x1; x++, at += 4) {
        const id = this.ids[y * this.width + x];
        if (id === 0) continue;
        const along = (x + y) % stripe;
        const rgb = along < this.unit ? [0, 0, 0] : along < 2 * this.unit ? [255, 255, 255] : null;
        image.data.set(rgb ?? this.rgb.get(id) ?? [128, 128, 128], at);
        image.data[at + 3] = 255;
      }
    }
    this.context.putImageData(image, x0, y0);
  }
}
