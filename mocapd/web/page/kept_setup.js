// A setup that was going on when mocapd ended: gone on with, or forgotten.

import { button, element } from "./setup.js";

const TITLES = { cameras: "Cameras", lens: "Lens", room: "Room", colour: "Colours", body: "Body" };

export class KeptSetup {
  /** root: where the offer is put; link.send takes the choice. */
  constructor(root, link) {
    this.root = root;
    this.link = link;
    this.told = "";
  }

  /** kept: {when, done: [steps]}, or null when nothing is offered. */
  update(kept) {
    const told = JSON.stringify(kept);
    if (told === this.told) return;
    this.told = told;
    this.root.hidden = kept === null;
    this.root.replaceChildren(...(kept === null ? [] : [this.offer(kept)]));
  }

  offer({ when, done }) {
    const time = new Date(when).toLocaleString();
    const steps = done.map((name) => TITLES[name] ?? name).join(", ");
    const text = `A setup from ${time} is kept${steps ? ` (done: ${steps})` : ""}: go on with it, or begin anew.`;
    const id = "kept-setup-text";
    return element(
      "section",
      { class: "panel", "aria-labelledby": id },
      element("p", { id }, text),
      button("resume", "Go on with it", () => this.link.send("resume"), {
        id: "resume",
        class: "primary",
        "aria-describedby": id,
      }),
      " ",
      button("begin-anew", "Begin anew", () => this.link.send("begin_anew"), {
        id: "begin-anew",
        "aria-describedby": id,
      }),
    );
  }
}
