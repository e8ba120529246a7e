// How far off a body may be, as a soft band around its bones: as wide at each joint as that is uncertain.

const OPACITY = 0.22;

/**
 * Fills them as one, so that nothing is darker where they overlap. `capsules`: of each bone its two ends in canvas
 * pixels with a radius, [[x, y, radius], [x, y, radius]].
 */
export function drawHalo(context, capsules, colour) {
  context.save();
  context.globalAlpha *= OPACITY;
  context.fillStyle = colour;
  context.beginPath();
  for (const [from, to] of capsules) {
    disc(context, from);
    disc(context, to);
    band(context, from, to);
  }
  context.fill();
  context.restore();
}

// All the same way round, or two that overlap would take each other out.
function disc(context, [x, y, radius]) {
  context.moveTo(x + radius, y);
  context.arc(x, y, radius, 0, 2 * Math.PI, true);
}

function band(context, from, to) {
  const [along, down] = [to[0] - from[0], to[1] - from[1]];
  const length = Math.hypot(along, down);
  if (length === 0) return;
  const [right, below] = [-down / length, along / length];
  const corner = ([x, y, radius], side) => [x + side * right * radius, y + side * below * radius];
  context.moveTo(...corner(from, 1));
  for (const one of [corner(to, 1), corner(to, -1), corner(from, -1)]) context.lineTo(...one);
  context.closePath();
}
