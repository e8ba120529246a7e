// The frame of the setup: the list of steps, what to do next, trouble, and the step's own part.

import { Sound } from "./sound.js";

const TITLES = {
  cameras: "Cameras",
  lens: "Lens",
  room: "Room",
  colour: "Colours",
  body: "Body",
  check: "Check",
};
const NO_SHIRT =
  "Two cameras or more follow you in any clothes: leave the room empty for a second when tracking begins, then stand " +
  "upright and face them. Expect errors of 2 to 9 cm; with the shirt they are 1.0 to 3.5 cm.";
const STATES = {
  waiting: "Your turn",
  working: "Working",
  done: "Done",
  failed: "Needs attention",
};

/** An element with attributes, text or children: element("p", {class: "hint"}, "text"). */
export function element(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === true) made.setAttribute(name, "");
    else if (value !== false && value !== null && value !== undefined) made.setAttribute(name, value);
  }
  made.append(...children);
  return made;
}

/** A button that says what it does and can be found by `data-action`. */
export function button(action, text, onClick, attributes = {}) {
  const made = element("button", { type: "button", "data-action": action, ...attributes }, text);
  made.addEventListener("click", onClick);
  return made;
}

/** Sets a text only when it differs, so that a screen reader is not told the same again. */
export function setText(node, text) {
  if (node.textContent !== text) node.textContent = text;
}

/** Builds the setup in `root`, follows the link, and shows one step at a time. */
export class Setup {
  constructor(root, link) {
    this.root = root;
    this.link = link;
    this.step = null; // name of the step whose part is shown
    this.part = null;
    this.loading = null; // name of the step whose part is being fetched
    this.told = ""; // problems as last drawn
    this.without = null; // a shirt, as just said here
    this.build();
    this.stopListening = link.onView((view) => this.update(view));
  }

  build() {
    this.steps = element("ol", { class: "steps" });
    this.heading = element("h1", { id: "step-title", tabindex: "-1" });
    this.state = element("span", { id: "step-state", class: "state" });
    this.sentence = element("p", { id: "sentence", class: "sentence", role: "status" });
    this.progress = element("progress", {
      id: "step-progress",
      max: "1",
      value: "0",
      "aria-label": "How much of this step is done",
    });
    this.refused = element("p", { id: "refused", class: "problem bad", role: "alert", hidden: true });
    this.problems = element("ul", { id: "problems", class: "problems", "aria-label": "Problems" });
    this.cameras = element("div", { id: "cameras", class: "cameras" });
    this.place = element("section", { id: "part", class: "part", "aria-labelledby": "step-title" });
    this.again = button("again", "Start again", () => this.link.send("again"), { id: "again" });
    this.next = button("next", "Next", () => this.link.send("next"), {
      id: "next",
      class: "primary",
    });
    this.shirt = element("input", { type: "checkbox", id: "no-shirt", "aria-describedby": "no-shirt-note" });
    this.shirt.addEventListener("change", () => {
      this.without = this.shirt.checked; // until the setup has taken it, or refused
      this.link.send("wear", { shirt: !this.without });
    });
    this.shirtNote = element("p", { id: "no-shirt-note", class: "hint-text" });
    this.sound = new Sound();
    this.loud = button("sound", "Sound", () => {
      this.sound.switch();
      this.loud.setAttribute("aria-pressed", String(this.sound.on));
    }, { id: "sound", "aria-pressed": String(this.sound.on), title: "A chime and a voice say what to do" });
    this.back = button("back", "Back", () => this.link.send("go", { step: this.before }), { id: "back" });
    this.lead = element("span", { id: "lead", class: "lead-buttons" }); // the step's own, where it has one
    this.root.replaceChildren(
      element("nav", { "aria-label": "Steps of the setup" }, this.steps),
      element("div", { class: "step-head" }, this.heading, this.state, this.loud),
      element(
        "div",
        { class: "lead" },
        this.sentence,
        this.progress,
        element("div", { class: "step-buttons" }, this.back, this.again, this.lead, this.next),
      ),
      this.refused,
      this.problems,
      this.cameras,
      this.place,
      element("div", { class: "no-shirt" }, element("label", {}, this.shirt, "I have no shirt"), this.shirtNote),
    );
  }

  /** A wizard view has come. */
  update(wizard) {
    this.newest = wizard;
    this.drawSteps(wizard);
    this.drawCameras(wizard);
    const view = wizard.view;
    setText(this.heading, TITLES[wizard.step] ?? wizard.step);
    setText(this.state, STATES[view.state] ?? view.state);
    this.state.className = `state ${view.state}`;
    setText(this.sentence, view.sentence);
    this.progress.value = Math.min(1, Math.max(0, view.progress));
    this.drawProblems(view.problems);
    this.drawRefused(wizard.refused);
    const last = wizard.step === wizard.steps[wizard.steps.length - 1];
    this.isLast = last;
    this.next.disabled = view.state !== "done" || !wizard.driver;
    this.again.disabled = !wizard.driver;
    this.before = wizard.steps[wizard.steps.indexOf(wizard.step) - 1];
    this.back.hidden = this.before === undefined;
    this.back.disabled = !wizard.driver;
    this.sound.hear(wizard.step, view);
    if (this.without === !wizard.shirt || wizard.refused) this.without = null;
    this.shirt.checked = this.without ?? !wizard.shirt;
    this.shirt.disabled = !wizard.driver;
    setText(this.shirtNote, wizard.shirt ? "" : NO_SHIRT);
    this.root.classList.toggle("watching", !wizard.driver);
    if (wizard.step !== this.step) this.open(wizard.step);
    else if (this.part) this.part.update(wizard.view);
    this.oneButton();
  }

  /** While a step is not done its own button is the one to press. */
  oneButton() {
    const own = [...this.lead.querySelectorAll("button")].some((one) => !one.closest("[hidden]"));
    this.next.hidden = this.isLast || (own && this.newest.view.state !== "done");
  }

  drawSteps(wizard) {
    if (this.steps.childElementCount !== wizard.steps.length) {
      this.steps.replaceChildren(
        ...wizard.steps.map((name) =>
          element(
            "li",
            {},
            button(`go-${name}`, "", () => this.link.send("go", { step: name }), {
              "data-step": name,
            }),
          ),
        ),
      );
    }
    wizard.steps.forEach((name, i) => {
      const to = this.steps.children[i].firstElementChild;
      const done = wizard.done.includes(name);
      const current = name === wizard.step;
      setText(to, `${i + 1} ${TITLES[name] ?? name}${done ? " ✓" : ""}`);
      to.classList.toggle("done", done);
      to.disabled = !wizard.driver;
      if (current) to.setAttribute("aria-current", "step");
      else to.removeAttribute("aria-current");
      to.setAttribute("aria-label", `Step ${i + 1}, ${TITLES[name] ?? name}${done ? ", done" : ""}`);
    });
  }

  drawCameras(wizard) {
    const names = wizard.cameras ?? [];
    const shown = [...this.cameras.querySelectorAll("camera-picture")];
    if (shown.map((one) => one.getAttribute("camera")).join("\n") === names.join("\n")) return;
    this.cameras.replaceChildren(
      ...names.map((name) =>
        element(
          "figure",
          { class: "camera", "data-camera": name },
          element("camera-picture", { camera: name }),
          element("figcaption", {}, name),
        ),
      ),
    );
  }

  drawProblems(problems) {
    const told = JSON.stringify(problems);
    if (told === this.told) return;
    this.told = told;
    this.problems.hidden = problems.length === 0;
    this.problems.replaceChildren(
      ...problems.map((one) => element("li", { class: "problem" }, ...problemParts(one))),
    );
  }

  drawRefused(refused) {
    this.refused.hidden = !refused;
    const told = refused ? JSON.stringify(refused) : "";
    if (told === this.refused.dataset.told) return;
    this.refused.dataset.told = told;
    this.refused.replaceChildren(...(refused ? problemParts(refused) : []));
  }

  /** Fetches the step's part and puts it in the place of the one before. */
  async open(name) {
    if (this.loading === name) return;
    this.loading = name;
    const module = await import(`./step_${name}.js`);
    // another step may have been chosen while this one was fetched
    if (this.loading !== name) return;
    this.loading = null;
    this.close();
    this.step = name;
    this.root.dataset.step = name;
    const title = module.title ?? TITLES[name];
    setText(this.heading, title);
    TITLES[name] = title;
    const place = element("div", { class: `part-${name}` });
    this.place.replaceChildren(place);
    this.part = new module.StepPart(place, this.link, this.cameras);
    this.lead.replaceChildren(...(this.part.lead ?? []));
    if (this.newest.step === name) this.part.update(this.newest.view);
    this.oneButton();
    if (this.opened) this.heading.focus({ preventScroll: false });
    this.opened = true; // on the first step the focus stays where the browser put it
  }

  close() {
    if (this.part) this.part.destroy();
    this.lead.replaceChildren();
    this.part = null;
    this.step = null;
  }

  destroy() {
    this.close();
    this.sound.destroy();
    if (this.stopListening) this.stopListening();
    this.root.replaceChildren();
  }
}

function problemParts(problem) {
  const parts = [];
  if (problem.where) parts.push(element("strong", {}, `${problem.where}: `));
  parts.push(problem.what);
  if (problem.fix) parts.push(element("span", { class: "fix" }, ` ${sentenceOf(problem.fix)}`));
  return parts;
}

function sentenceOf(text) {
  return `→ ${text.charAt(0).toUpperCase()}${text.slice(1)}.`.replace(/\.\.$/, ".");
}
