// The step Room: with the board or without one; how often the cameras saw it together; the room from above.

import { button, element, setText } from "./setup.js";

export const title = "Room";

const METHODS = { board: "With the board", wearer: "Without a board" };

export class StepPart {
  constructor(root, link, cameras) {
    this.link = link;
    this.cameras = cameras;
    this.methods = element("div", { class: "row", role: "group", "aria-label": "How" });
    this.choices = new Map();
    this.board = new BoardPart(link);
    this.wearer = element("div", { id: "wearer-room" });
    this.figures = element("p", { id: "room-figures" });
    this.plan = new Plan();
    root.append(this.methods, this.board.root, this.wearer, this.figures, this.plan.root);
  }

  update(view) {
    const details = view.details;
    this.drawMethods(details);
    this.board.root.hidden = details.method !== "board";
    this.wearer.hidden = details.method !== "wearer";
    if (details.method === "board") this.board.update(details, view.state);
    else this.drawWearer(details, view.state);
    setText(this.figures, figures(details));
    this.plan.update(details.plan ?? null, details.names ?? {});
  }

  drawMethods(details) {
    const names = details.methods ?? [];
    this.methods.hidden = names.length < 2;
    for (const name of names) {
      if (!this.choices.has(name)) {
        const choice = button(`method-${name}`, METHODS[name] ?? name, () =>
          this.link.send("method", { method: name }),
        );
        this.choices.set(name, choice);
        this.methods.append(choice);
      }
      this.choices.get(name).setAttribute("aria-pressed", String(name === details.method));
    }
  }

  /** What the method without a board offers: its buttons come with its details. */
  drawWearer(details, state) {
    const actions = details.actions ?? [];
    const told = JSON.stringify(actions);
    if (told !== this.wearer.dataset.told) {
      this.wearer.dataset.told = told;
      this.wearer.replaceChildren(
        ...actions.map(({ verb, text }) => button(verb, text, () => this.link.send(verb), { id: verb })),
      );
    }
    this.wearer.dataset.state = state;
  }

  destroy() {}
}

/** Moments of pairs of cameras, and the floor. */
class BoardPart {
  constructor(link) {
    this.pairs = element("tbody");
    this.table = element(
      "div",
      { class: "table-place" },
      element(
        "table",
        { id: "pairs" },
        element("caption", { class: "visually-hidden" }, "Where cameras saw the board together"),
        element(
          "thead",
          {},
          element("tr", {}, element("th", { scope: "col" }, "Cameras"), element("th", { scope: "col" }, "Places")),
        ),
        this.pairs,
      ),
    );
    this.count = element("p", { id: "moments", class: "soft" });
    this.solve = button("solve", "Go on with these places", () => link.send("solve"), { id: "solve" });
    this.floor = button("floor", "The board lies on the floor", () => link.send("floor"), {
      id: "floor",
      class: "primary",
    });
    this.skip = button("skip-floor", "Guess the floor", () => link.send("skip_floor"), {
      id: "skip-floor",
    });
    this.root = element(
      "div",
      {},
      this.table,
      this.count,
      element("div", { class: "row" }, this.solve, this.floor, this.skip),
    );
  }

  update(details, state) {
    const pairs = details.pairs ?? [];
    if (this.pairs.childElementCount !== pairs.length) {
      this.pairs.replaceChildren(
        ...pairs.map(() => element("tr", {}, element("th", { scope: "row" }), element("td"))),
      );
    }
    pairs.forEach((pair, i) => {
      const [names, shared] = this.pairs.children[i].children;
      setText(names, `${details.names[pair.a]} and ${details.names[pair.b]}`);
      setText(shared, String(pair.shared));
    });
    const collecting = details.stage === "collect";
    this.table.hidden = pairs.length === 0;
    this.count.hidden = pairs.length === 0;
    setText(this.count, `Places so far: ${details.moments} of about ${details.enough}.`);
    this.solve.hidden = !collecting || !details.can_solve;
    this.solve.disabled = Boolean(details.solving);
    this.floor.hidden = details.stage !== "floor";
    this.floor.disabled = !details.at_rest;
    this.skip.hidden = !details.can_skip_floor;
    this.root.dataset.state = state;
  }
}

function figures(details) {
  const quality = details.quality;
  if (!quality) return "";
  const area =
    quality.play_area_cm === null ? "" : `${quality.play_area_cm.toFixed(2)} cm in the play area, `;
  const each = Object.entries(quality.cameras)
    .map(([id, one]) => `${details.names?.[id] ?? id} ${one.rms_px.toFixed(2)} px`)
    .join(", ");
  const floor = details.stage === "done" && !details.floor_known ? " The floor is guessed." : "";
  return `Error: ${area}${quality.rms_px.toFixed(2)} px in all (${each}).${floor}`;
}

/** The room from above, players facing down the page: cameras with what they see, places of the board. */
class Plan {
  constructor() {
    this.canvas = element("canvas", { width: 640, height: 480, role: "img", class: "plan" });
    this.canvas.style.width = "100%";
    this.root = element(
      "figure",
      { class: "camera", hidden: true },
      this.canvas,
      element("figcaption", {}, "The room from above; players look down the page"),
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
    const points = [...plan.cameras.map((camera) => camera.at_m), ...plan.boards_m, [0, 0, 0]];
    const low = [0, 2].map((axis) => Math.min(...points.map((point) => point[axis])) - 0.5);
    const high = [0, 2].map((axis) => Math.max(...points.map((point) => point[axis])) + 0.5);
    const { width, height } = this.canvas;
    const scale = Math.min(width / (high[0] - low[0]), height / (high[1] - low[1]));
    // a player at rest looks along +z, its left is +x: with +z down the page, +x is to the right
    const at = (x, z) => [
      width / 2 + (x - (low[0] + high[0]) / 2) * scale,
      height / 2 + (z - (low[1] + high[1]) / 2) * scale,
    ];
    const css = getComputedStyle(this.canvas);
    const colour = (name) => css.getPropertyValue(name).trim();
    const context = this.canvas.getContext("2d");
    context.fillStyle = colour("--panel");
    context.fillRect(0, 0, width, height);
    this.grid(context, at, low, high, colour("--line"));
    context.fillStyle = colour("--text-soft");
    for (const [x, , z] of plan.boards_m) dot(context, at(x, z), 4);
    for (const camera of plan.cameras) this.camera(context, camera, at, scale, colour("--accent"));
    context.fillStyle = colour("--text");
    context.font = "600 18px system-ui, sans-serif";
    for (const { id, at_m } of plan.cameras) {
      const [x, y] = at(at_m[0], at_m[2]);
      const name = names[id] ?? id;
      const across = context.measureText(name).width;
      context.fillText(name, Math.min(Math.max(4, x + 10), width - across - 4), Math.max(20, y - 10));
    }
    context.fillText("0", ...at(0, 0).map((pixel) => pixel + 6));
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
    dot(context, [x, y], 7);
  }
}

function dot(context, [x, y], radius) {
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
  context.fill();
}
