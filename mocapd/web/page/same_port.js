// Webcams that are in another USB port than when they were calibrated: asked about once.

import { button, element } from "./setup.js";

export class PortQuestions {
  /** root: where the questions are put; link.send takes the answers. */
  constructor(root, link) {
    this.root = root;
    this.link = link;
    this.told = "";
  }

  /** moved: [{camera, was, now}] not yet answered. */
  update(moved) {
    const told = JSON.stringify(moved);
    if (told === this.told) return;
    this.told = told;
    this.root.hidden = moved.length === 0;
    this.root.replaceChildren(...moved.map((one) => this.question(one)));
  }

  question({ camera, was, now }) {
    const answer = (same) => () => this.link.send("same_port", { camera, same });
    const id = `port-${camera}`;
    return element(
      "section",
      { class: "panel", "aria-labelledby": id },
      element("p", { id }, `${camera}: same camera, new port? It was ${was}, and is now ${now}.`),
      button(`same-${camera}`, "Same camera", answer(true), { class: "primary", "aria-describedby": id }),
      " ",
      button(`other-${camera}`, "Another camera", answer(false), { "aria-describedby": id }),
    );
  }
}
