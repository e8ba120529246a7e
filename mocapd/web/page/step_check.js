// The step Check: a verdict for each camera after five seconds of moving, and Save.

import { button, element, setText } from "./setup.js";

export const title = "Check";

const GRADES = { good: "Good", doubtful: "Doubtful", bad: "Bad" };
const TRACKING = { live: "tracking", coasting: "lost from sight for a moment", lost: "nobody is seen" };
const COLUMNS = [
  ["Camera", "", (one) => one.camera],
  ["Verdict", "", (one) => GRADES[one.grade] ?? one.grade],
  ["Disagrees in the picture", "how far this camera sees the wearer from where all cameras together have them; no error of the pose", (one) => unit(one.reprojection_px, "px")],
  ["Disagrees in the room", "the same where the person stands", (one) => unit(one.cm, "cm")],
  ["Recognised", "share of the visible shirt, or without one of the body, that is seen where it is drawn", (one) => percent(one.match)],
  ["Saw the person", "share of the pictures with the person in view", (one) => percent(one.seen)],
  ["Pictures lost", "", (one) => percent(one.dropped)],
  ["Rate", "pictures a second", (one) => unit(one.rate_hz, "Hz")],
];

export class StepPart {
  constructor(root, link) {
    this.root = root;
    this.told = "";
    const href = new URL("step_check.css", import.meta.url).href;
    this.style = element("link", { rel: "stylesheet", href });
    document.head.append(this.style);
    this.tracking = element("p", { id: "tracking", class: "soft" });
    this.table = element("table", { id: "verdicts", class: "verdicts" });
    this.measure = button("measure", "Check once more", () => link.send("measure"), {
      id: "measure",
    });
    this.save = button("save", "Save", () => link.send("save"), { id: "save", class: "primary" });
    root.replaceChildren(
      this.tracking,
      element("div", { class: "verdicts-scroll" }, this.table),
    );
    this.lead = [this.measure, this.save];
  }

  update(view) {
    const { phase, tracking, rate_hz, verdicts } = view.details;
    const rate = rate_hz ? `, ${rate_hz} times a second` : "";
    setText(this.tracking, tracking ? `The tracker: ${TRACKING[tracking] ?? tracking}${rate}.` : "");
    this.save.disabled = phase !== "judged";
    this.measure.disabled = phase !== "judged";
    this.drawVerdicts(verdicts ?? []);
  }

  drawVerdicts(verdicts) {
    const told = JSON.stringify(verdicts);
    if (told === this.told) return;
    this.told = told;
    this.table.hidden = verdicts.length === 0;
    const heads = COLUMNS.map(([name, words]) => element("th", { scope: "col", title: words || null }, name));
    this.table.replaceChildren(
      element("caption", {}, "How far each camera can be relied on"),
      element("thead", {}, element("tr", {}, ...heads)),
      element("tbody", {}, ...verdicts.map(row)),
    );
  }

  destroy() {
    this.style.remove();
    this.root.replaceChildren();
  }
}

function row(one) {
  const [name, ...rest] = COLUMNS.map(([head, , text]) => [head, text(one)]);
  const cells = rest.map(([head, text]) => element("td", { "data-head": head }, text));
  cells[0].className = `grade ${one.grade}`;
  return element("tr", { "data-camera": one.camera }, element("th", { scope: "row" }, name[1]), ...cells);
}

function unit(value, name) {
  return value === null ? "–" : `${value} ${name}`;
}

function percent(share) {
  return share === null ? "–" : `${Math.round(100 * share)} %`;
}
