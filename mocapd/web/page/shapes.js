// Shapes over a picture: points, lines, polygons, texts and halos, in pixels of the camera's whole frame.

import { drawHalo } from "./halo.js";

const STYLES = ["good", "bad", "hint", "bone", "cell-0", "cell-1", "cell-2", "cell-3"];
const POINT_RADIUS = 3.5; // CSS px, as all below
const LINE_WIDTH = 2.5;
const TEXT_SIZE = 14;

/** The colours of the styles, from the style sheet: {good: "#...", ...}. */
export function shapeColours(node) {
  const css = getComputedStyle(node);
  return Object.fromEntries(
    STYLES.map((name) => [name, css.getPropertyValue(`--shape-${name}`).trim()]),
  );
}

/** Draws them on a 2D context; `scale` is canvas pixels per frame pixel, `unit` per CSS pixel. */
export function drawShapes(context, shapes, colours, scale, unit) {
  for (const shape of shapes) {
    const colour = colours[shape.style] ?? colours.good;
    const at = shape.at_px.map(([x, y]) => [(x + 0.5) * scale, (y + 0.5) * scale]);
    if (at.length > 0) KINDS[shape.kind]?.(context, at, colour, unit, shape, scale);
  }
}

const KINDS = {
  points: drawPoints,
  line: drawLine,
  polygon: drawPolygon,
  text: drawText,
  halo: drawBands,
};

function drawPoints(context, at, colour, unit) {
  for (const [x, y] of at) {
    context.beginPath();
    context.arc(x, y, POINT_RADIUS * unit, 0, 2 * Math.PI);
    outlined(context, colour, 1.5 * unit, () => context.stroke());
  }
}

function drawLine(context, at, colour, unit, shape) {
  path(context, at);
  context.setLineDash(shape.style === "hint" ? [6 * unit, 4 * unit] : []);
  outlined(context, colour, LINE_WIDTH * unit, () => context.stroke());
  context.setLineDash([]);
}

function drawPolygon(context, at, colour, unit, shape) {
  path(context, at);
  context.closePath();
  if (shape.style.startsWith("cell-")) {
    context.fillStyle = colour; // cells of a map: filled, their colours let the picture through
    context.fill();
    return;
  }
  outlined(context, colour, LINE_WIDTH * unit, () => context.stroke());
}

function drawText(context, at, colour, unit, shape) {
  context.font = `600 ${TEXT_SIZE * unit}px system-ui, sans-serif`;
  context.textBaseline = "bottom";
  const [x, y] = at[0];
  const width = context.measureText(shape.text).width;
  // whatever does not fit is shown anyway
  const left = Math.max(2 * unit, Math.min(x, context.canvas.width - width - 2 * unit));
  const bottom = Math.max(TEXT_SIZE * 1.3 * unit, y);
  context.lineWidth = 4 * unit;
  context.lineJoin = "round";
  context.strokeStyle = "#000";
  context.strokeText(shape.text, left, bottom);
  context.fillStyle = colour;
  context.fillText(shape.text, left, bottom);
}

/** Two points of each band, one after the other. */
function drawBands(context, at, colour, unit, shape, scale) {
  const ends = at.map(([x, y], i) => [x, y, shape.radii_px[i] * scale]);
  const bands = ends.flatMap((end, i) => (i % 2 === 0 ? [[end, ends[i + 1]]] : []));
  drawHalo(context, bands, colour);
}

function path(context, at) {
  context.beginPath();
  at.forEach(([x, y], i) => (i === 0 ? context.moveTo(x, y) : context.lineTo(x, y)));
}

/** Strokes twice, dark below, so that it shows on any picture. */
function outlined(context, colour, width, stroke) {
  context.lineCap = context.lineJoin = "round";
  context.strokeStyle = "#000b";
  context.lineWidth = width * 1.9;
  stroke();
  context.strokeStyle = colour;
  context.lineWidth = width;
  stroke();
}
