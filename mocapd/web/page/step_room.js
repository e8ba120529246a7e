// The step Room: with the board or without one; how often the cameras saw it together; the room from above.

import { button, element, setText } from "./setup.js";
import { Plan } from "./room_plan.js";
import { boardPicture } from "./step_lens.js";

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
    this.lead = [this.board.buttons, this.wearer];
    root.append(this.methods, this.board.root, this.figures, this.plan.root);
  }

  update(view) {
    const details = view.details;
    this.drawMethods(details);
    this.board.root.hidden = this.board.buttons.hidden = details.method !== "board";
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
    this.buttons = element("span", { class: "lead-buttons" }, this.solve, this.floor, this.skip);
    this.together = boardPicture("board_together.svg", "Hold the board where two cameras see it, still for a second, at many places");
    this.flat = boardPicture("board_floor.svg", "Then lay it flat on the floor: there is the origin");
    this.root = element("div", {}, this.table, this.count, this.together, this.flat);
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
    this.together.hidden = !collecting;
    this.flat.hidden = details.stage !== "floor";
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
