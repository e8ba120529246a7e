// The room from above: cameras, what they see, where a person is seen whole, places of the board; with scale and legend.

import { element } from "./setup.js";

const MARGIN_M = 0.5;
const SCALE_PX = 30; // below the plan
const NAME_PX = 22; // above and below the plan, for a camera's name
const DOT_PX = 7;

/** The room from above, players facing down the page: cameras with what they see, places of the board. */
export class Plan {
  constructor() {
    this.canvas = element("canvas", { width: 640, height: 450, role: "img", class: "plan" });
    this.canvas.style.width = "100%";
    this.root = element(
      "figure",
      { class: "camera", hidden: true },
      this.canvas,
      (this.legend = element("ul", { class: "plan-legend" })),
      (this.caption = element("figcaption", {})),
    );
    this.told = "";
  }

  update(plan, names) {
    const told = JSON.stringify([plan, names]);
    if (told === this.told) return;
    this.told = told;
    this.root.hidden = !plan;
    if (plan) this.draw(plan, names);
  }

  draw(plan, names) {
    const label = plan.cameras.map(({ id, at_m: [x, y, z] }) => {
      const at = [x, z].map((metres) => metres.toFixed(2)).join(", ");
      return `${names[id] ?? id} at ${at} m, ${y.toFixed(2)} m high`;
    });
    this.canvas.setAttribute("aria-label", `The room from above: ${label.join("; ")}`);
    this.caption.textContent = `The room from above; players look down the page. ${summary(plan)}`;
    const cells = (plan.seen_m ?? []).map(([x, z]) => [x, 0, z]);
    const points = [...plan.cameras.map((camera) => camera.at_m), ...plan.boards_m, ...cells, [0, 0, 0]];
    const low = [0, 2].map((axis) => Math.min(...points.map((point) => point[axis])) - MARGIN_M);
    const high = [0, 2].map((axis) => Math.max(...points.map((point) => point[axis])) + MARGIN_M);
    const { width } = this.canvas;
    const height = this.canvas.height - SCALE_PX;
    const scale = Math.min(width / (high[0] - low[0]), (height - 2 * NAME_PX) / (high[1] - low[1]));
    // a player at rest looks along +z, its left is +x: with +z down the page, +x is to the right
    const at = (x, z) => [
      width / 2 + (x - (low[0] + high[0]) / 2) * scale,
      height / 2 + (z - (low[1] + high[1]) / 2) * scale,
    ];
    const css = getComputedStyle(this.canvas);
    const colour = (name) => css.getPropertyValue(name).trim();
    const context = this.canvas.getContext("2d");
    context.fillStyle = colour("--panel");
    context.fillRect(0, 0, width, this.canvas.height);
    context.fillStyle = colour("--good-soft");
    const half = (plan.cell_m ?? 0) / 2;
    for (const [x, , z] of cells) context.fillRect(...at(x - half, z - half), 2 * half * scale + 1, 2 * half * scale + 1);
    this.grid(context, at, low, high, colour("--line"));
    context.fillStyle = colour("--text-soft");
    for (const [x, , z] of plan.boards_m) dot(context, at(x, z), 4);
    for (const camera of plan.cameras) this.camera(context, camera, at, scale, colour("--accent"));
    context.fillStyle = colour("--text");
    context.font = "600 18px system-ui, sans-serif";
    for (const { id, at_m, towards } of plan.cameras) {
      const name = names[id] ?? id;
      context.fillText(name, ...nameAt(at(at_m[0], at_m[2]), towards, context.measureText(name).width, width));
    }
    context.fillText("0", ...at(0, 0).map((pixel) => pixel + 6));
    this.scaleBar(context, colour, scale);
    this.drawLegend(plan);
  }

  /** A metre. */
  scaleBar(context, colour, scale) {
    const [top, left] = [this.canvas.height - SCALE_PX, 16];
    context.fillStyle = colour("--panel");
    context.fillRect(0, top, this.canvas.width, SCALE_PX);
    context.strokeStyle = context.fillStyle = colour("--text");
    context.lineWidth = 2;
    context.beginPath();
    context.moveTo(left, top + 10);
    context.lineTo(left, top + 22);
    context.moveTo(left, top + 16);
    context.lineTo(left + scale, top + 16);
    context.moveTo(left + scale, top + 10);
    context.lineTo(left + scale, top + 22);
    context.stroke();
    context.font = "600 16px system-ui, sans-serif";
    context.fillText("1 m", left + scale + 10, top + 22);
  }

  /** What the colours mean. */
  drawLegend(plan) {
    const whole = plan.cameras.length > 1 ? "two cameras see you whole" : "the camera sees you whole";
    const colours = [["of-camera", "camera"]];
    if (plan.boards_m.length) colours.push(["of-board", "the board was here"]);
    if (plan.seen_m?.length) colours.push(["of-floor", whole]);
    this.legend.replaceChildren(
      ...colours.map(([look, text]) => element("li", {}, element("span", { class: `plan-key ${look}` }), text)),
    );
  }

  grid(context, at, low, high, colour) {
    context.strokeStyle = colour;
    context.lineWidth = 1;
    context.beginPath();
    for (let x = Math.ceil(low[0]); x <= high[0]; x += 1) {
      context.moveTo(...at(x, low[1]));
      context.lineTo(...at(x, high[1]));
    }
    for (let z = Math.ceil(low[1]); z <= high[1]; z += 1) {
      context.moveTo(...at(low[0], z));
      context.lineTo(...at(high[0], z));
    }
    context.stroke();
    context.lineWidth = 3;
    context.beginPath();
    context.moveTo(...at(-0.15, 0));
    context.lineTo(...at(0.15, 0));
    context.moveTo(...at(0, -0.15));
    context.lineTo(...at(0, 0.15));
    context.stroke();
  }

  camera(context, { at_m, towards, half_angle_rad: half }, at, scale, colour) {
    const [x, y] = at(at_m[0], at_m[2]);
    const angle = Math.atan2(towards[2], towards[0]);
    context.strokeStyle = colour;
    context.fillStyle = colour;
    context.lineWidth = 2;
    context.beginPath();
    for (const side of [-half, half]) {
      context.moveTo(x, y);
      context.lineTo(x + scale * Math.cos(angle + side), y + scale * Math.sin(angle + side));
    }
    context.stroke();
    dot(context, [x, y], DOT_PX);
  }
}

function dot(context, [x, y], radius) {
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
  context.fill();
}

/** Where a camera's name begins [px]: behind the camera, out of what it sees. */
function nameAt([x, y], [right, , down], across, width) {
  const length = Math.hypot(right, down) || 1;
  const left = x - (right / length) * (across / 2) - across / 2;
  const baseline = down > 0 ? y - DOT_PX - 5 : y + DOT_PX + 18;
  return [Math.min(Math.max(4, left), width - across - 4), baseline];
}

/** The figures of the rig, in words. */
function summary(plan) {
  if (!plan.size_m) return "";
  const [across, along] = plan.size_m.map((metres) => metres.toFixed(1));
  const seen = plan.seen_m.length ? `on ${across} × ${along} m of the floor (green)` : "nowhere";
  const parts = [`You are seen whole ${seen}`];
  if (plan.cameras.length > 1) parts.push(`cameras ${plan.baseline_m.toFixed(1)} m apart`);
  if (plan.angle_deg !== null && plan.angle_deg !== undefined) parts.push(`${plan.angle_deg} degrees`);
  return `${parts.join(", ")}.`;
}
