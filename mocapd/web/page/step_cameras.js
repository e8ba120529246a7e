// The step Cameras: one card a camera with its name, its state and what can be done; other nodes below.

import { KeptSetup } from "./kept_setup.js";
import { PortQuestions } from "./same_port.js";
import { button, element, setText } from "./setup.js";
import { boardPicture } from "./step_lens.js";

export const title = "Cameras";

const PHASES = {
  waiting: "Waiting for pictures",
  settling: "Settling",
  locking: "Locking",
  locked: "Ready",
  lost: "No picture",
};

const WHERE =
  "Two cameras 2.5 to 3.5 m from the middle of the play area, 1.2 to 2 m high, 60 to 100 degrees apart, both turned to its " +
  "middle: each sees you whole, with your arms up, wherever you play.";
const CONTROLS = [
  ["exposure", "exposure", (value) => `${value / 10} ms`],
  ["gain", "gain", String],
  ["wb_temperature", "white balance", (value) => `${value} K`],
  ["focus", "focus", String],
  ["power_line_hz", "mains", (value) => `${value} Hz`],
];

export class StepPart {
  constructor(root, link, cameras) {
    this.root = root;
    this.link = link;
    this.pictures = cameras;
    this.cards = new Map();
    this.othersTold = "";
    this.style = element("link", { rel: "stylesheet", href: new URL("step_cameras.css", import.meta.url).href });
    document.head.append(this.style);
    this.list = element("div", { class: "camera-cards" });
    this.others = element("section", { class: "other-nodes", "aria-labelledby": "other-nodes-title" });
    this.others.hidden = true;
    const questions = element("div", { id: "port-questions", hidden: true });
    this.ports = new PortQuestions(questions, link);
    const kept = element("div", { id: "kept-setup", hidden: true });
    this.kept = new KeptSetup(kept, link);
    const where = element(
      "details",
      { id: "where-cameras-go", class: "panel", open: true },
      element("summary", {}, "Where cameras go"),
      boardPicture("camera_places.svg", WHERE, [
        [0, 0, 380, 300],
        [380, 0, 380, 300],
      ]),
    );
    root.replaceChildren(kept, questions, this.list, where, this.others);
  }

  update(view) {
    const rows = view.details.cameras ?? [];
    const names = rows.map((row) => row.id);
    if (names.join("\n") !== [...this.cards.keys()].join("\n")) {
      this.cards = new Map(rows.map((row) => [row.id, new Card(row, this.link)]));
      this.list.replaceChildren(...[...this.cards.values()].map((card) => card.root));
    }
    const last = rows.filter((row) => row.taken).length === 1;
    for (const row of rows) {
      this.cards.get(row.id).update(row, last);
      for (const figure of this.pictures.querySelectorAll("figure.camera")) {
        if (figure.dataset.camera === row.id) figure.classList.toggle("left-out", !row.taken);
      }
    }
    this.kept.update(view.details.kept ?? null);
    this.ports.update(view.details.moved ?? []);
    this.drawOthers(view.details.others ?? []);
  }

  drawOthers(nodes) {
    const told = JSON.stringify(nodes);
    if (told === this.othersTold) return;
    this.othersTold = told;
    this.others.hidden = nodes.length === 0;
    this.others.replaceChildren(
      element("h2", { id: "other-nodes-title" }, "Other cameras of this machine"),
      element("ul", { class: "problems" }, ...nodes.map(otherNode)),
    );
  }

  destroy() {
    for (const figure of this.pictures.querySelectorAll(".left-out")) {
      figure.classList.remove("left-out");
    }
    this.style.remove();
    this.root.replaceChildren();
  }
}

/** One camera. Made once and updated, so that a name can be typed while pictures come. */
class Card {
  constructor(row, link) {
    this.row = row;
    const heading = `camera-${row.id}`;
    const send = (verb, args = {}) => link.send(verb, { camera: row.id, ...args });
    this.name = element("input", {
      id: `name-${row.id}`,
      type: "text",
      maxlength: "40",
      placeholder: row.id,
      autocomplete: "off",
      "data-action": `name-${row.id}`,
    });
    this.name.addEventListener("change", () => send("name", { name: this.name.value }));
    this.state = element("span", { class: "state" });
    this.facts = element("p", { class: "facts" });
    this.controls = element("p", { class: "facts" });
    this.leave = button(`leave_out-${row.id}`, "Leave out", () => send("leave_out"));
    this.take = button(`take_in-${row.id}`, "Take in", () => send("take_in"));
    this.lock = button(`lock-${row.id}`, "Lock again", () => send("lock"));
    this.mode = button(`mode-${row.id}`, "", () => send("mode", this.row.offer));
    for (const one of [this.leave, this.take, this.lock, this.mode]) {
      one.setAttribute("aria-describedby", heading);
    }
    this.root = element(
      "section",
      { class: "panel camera-card", "data-camera": row.id, "aria-labelledby": heading },
      element("h2", { id: heading }, row.id),
      this.state,
      element("label", { for: this.name.id }, "Name ", this.name),
      this.facts,
      this.controls,
      element("div", { class: "camera-buttons" }, this.leave, this.take, this.lock, this.mode),
    );
  }

  update(row, last) {
    this.row = row;
    if (document.activeElement !== this.name) this.name.value = row.label;
    this.root.classList.toggle("left-out", !row.taken);
    setText(this.state, row.taken ? stateText(row) : "Left out");
    this.state.className = `state ${row.taken ? stateClass(row) : ""}`;
    setText(this.facts, facts(row));
    const held = CONTROLS.filter(([key]) => row.controls[key] !== undefined);
    setText(this.controls, held.length ? `Locked at ${held.map((one) => told(one, row)).join(", ")}` : "");
    this.controls.hidden = held.length === 0;
    this.leave.hidden = !row.taken;
    this.leave.disabled = last;
    this.take.hidden = row.taken;
    this.lock.hidden = !row.taken || !row.lockable;
    this.lock.disabled = row.phase !== "locked";
    this.mode.hidden = !row.taken || !row.offer;
    if (row.offer) setText(this.mode, `Use ${modeText(row.offer)}`);
  }
}

function told([key, name, text], row) {
  return `${name} ${text(row.controls[key])}`;
}

function stateText(row) {
  const text = PHASES[row.phase] ?? row.phase;
  const moving = row.phase === "settling" || row.phase === "locking";
  return moving ? `${text} ${Math.round(100 * row.share)} %` : text;
}

function stateClass(row) {
  if (row.phase === "lost") return "failed";
  return row.phase === "locked" ? "done" : "working";
}

function modeText(mode) {
  return `${mode.size_px[0]}×${mode.size_px[1]} at ${Math.round(mode.fps_hz)} Hz`;
}

function facts(row) {
  const measured = row.measured_hz ? `, ${row.measured_hz.toFixed(0)} measured` : "";
  return `${row.source}, ${modeText(row)}${measured}`;
}

function otherNode(node) {
  const parts = [element("strong", {}, [node.name, node.node].filter(Boolean).join(", ")), ": "];
  parts.push(node.problem || node.note);
  if (node.fix) parts.push(element("span", { class: "fix" }, ` → ${node.fix}`));
  return element("li", { class: node.problem ? "problem" : "soft" }, ...parts);
}
