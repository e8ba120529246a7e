// The step Colours: pictures are frozen, strokes are proposed; they are corrected here with a brush.

import { BrushCanvas } from "./brush.js";
import { base64, decodeGreyPng, encodeGreyPng } from "./grey_png.js";
import { button, element, setText } from "./setup.js";

export const title = "Colours";

const SIZES = [3, 5, 8, 12, 18, 26]; // radius, px of a picture 640 wide
const SEND_AFTER_MS = 300; // of the pen being lifted

export class StepPart {
  constructor(root, link, cameras) {
    this.root = root;
    this.link = link;
    this.live = cameras;
    this.me = Math.random().toString(36).slice(2);
    this.tool = { id: 1, radius: SIZES[3] };
    this.editors = new Map();
    this.active = null;
    this.style = element("link", { rel: "stylesheet", href: new URL("step_colour.css", import.meta.url).href });
    document.head.append(this.style);
    this.build();
    this.keys = (event) => this.keydown(event);
    document.addEventListener("keydown", this.keys);
  }

  build() {
    this.wait = element(
      "select",
      { id: "countdown-seconds" },
      ...[3, 5, 10].map((s) => element("option", { value: String(s) }, `${s} seconds`)),
    );
    this.freeze = button(
      "freeze",
      "Take the pictures",
      () => this.link.send("freeze", { seconds: Number(this.wait.value) }),
      { id: "freeze", class: "primary" },
    );
    this.propose = button("propose", "Propose strokes anew", () => this.link.send("propose"), {
      id: "propose",
    });
    this.count = element("p", { id: "countdown", class: "countdown", "aria-live": "assertive" });
    this.toolbar = element("div", { class: "toolbar", role: "toolbar", "aria-label": "Brush" });
    this.pictures = element("div", { class: "strokes-pictures" });
    this.seen = element("input", { type: "checkbox", id: "as-seen" });
    this.seen.addEventListener("change", () => {
      for (const editor of this.editors.values()) editor.draw(this.seen.checked);
    });
    this.personal = element("input", { type: "checkbox", id: "personal" });
    this.personal.addEventListener("change", () =>
      this.link.send("personal", { on: this.personal.checked }),
    );
    this.personalNote = element("span", { class: "hint-text", id: "personal-note" });
    this.drawing = element(
      "div",
      { class: "drawing" },
      this.toolbar,
      this.pictures,
      element(
        "div",
        { class: "stroke-options" },
        element("label", {}, this.seen, "As the tracker sees it"),
        element("label", {}, this.personal, "Use the colours of my own shirt"),
        this.personalNote,
      ),
    );
    this.drawing.hidden = true;
    this.lead = [this.freeze];
    this.root.replaceChildren(
      element(
        "div",
        { class: "take-pictures" },
        element("label", {}, "After", this.wait),
        this.propose,
      ),
      this.count,
      this.drawing,
    );
  }

  buildToolbar(colours) {
    this.colourButtons = new Map();
    const choices = colours.map((one) => {
      const swatch = element("span", { class: "swatch", "aria-hidden": "true" });
      swatch.style.backgroundColor = `rgb(${one.rgb.join(" ")})`;
      const made = button(
        `colour-${one.id}`,
        "",
        () => this.choose(one.id),
        { class: "colour", title: `${one.name}, key ${one.id % 10}` },
      );
      made.append(swatch, element("span", {}, one.name), element("kbd", {}, String(one.id % 10)));
      this.colourButtons.set(one.id, made);
      return made;
    });
    const eraser = button("erase", "Erase", () => this.choose(0), { title: "Erase, key E" });
    this.colourButtons.set(0, eraser);
    this.size = element("input", {
      type: "range",
      id: "brush-size",
      min: "0",
      max: String(SIZES.length - 1),
      value: String(SIZES.indexOf(this.tool.radius)),
    });
    this.size.addEventListener("input", () => this.resize(Number(this.size.value)));
    this.toolbar.replaceChildren(
      element("div", { class: "colours", role: "group", "aria-label": "Colours" }, ...choices),
      element(
        "div",
        { class: "tools" },
        eraser,
        button("undo", "Undo", () => this.undo(), { title: "Undo, Ctrl+Z" }),
        button("redo", "Redo", () => this.redo(), { title: "Redo, Ctrl+Shift+Z" }),
        element("label", {}, "Brush", this.size),
      ),
    );
    this.choose(this.tool.id);
  }

  update(view) {
    const details = view.details;
    if (!this.colourButtons && details.colours) {
      this.colours = details.colours;
      this.buildToolbar(this.colours);
    }
    const frozen = details.phase === "frozen";
    setText(this.freeze, frozen ? "Take the pictures again" : "Take the pictures");
    this.freeze.classList.toggle("primary", !frozen);
    this.propose.hidden = !frozen;
    this.propose.disabled = details.proposing;
    setText(this.count, details.phase === "countdown" ? String(details.countdown) : "");
    this.count.hidden = details.phase !== "countdown";
    this.live.hidden = frozen;
    this.drawing.hidden = !frozen;
    this.personal.checked = details.personal.wanted;
    const missing = details.personal.missing;
    setText(
      this.personalNote,
      details.personal.wanted && missing.length > 0
        ? `They are used once these have strokes too: ${missing.join(", ")}.`
        : "",
    );
    this.updateEditors(details.cameras);
  }

  updateEditors(cameras) {
    const names = Object.keys(cameras);
    const wanted = names.map((name) => `${name} ${cameras[name].picture}`).join("\n");
    if (wanted !== this.shown) {
      this.shown = wanted;
      this.editors = new Map(names.map((name) => [name, new Editor(name, cameras[name], this)]));
      this.pictures.replaceChildren(...[...this.editors.values()].map((one) => one.root));
      this.active = this.editors.get(names[0])?.brush ?? null;
    }
    for (const name of names) this.editors.get(name).update(cameras[name]);
  }

  choose(id) {
    this.tool.id = id;
    for (const [other, made] of this.colourButtons) {
      made.setAttribute("aria-pressed", String(other === id));
    }
  }

  resize(index) {
    const at = Math.min(SIZES.length - 1, Math.max(0, index));
    this.tool.radius = SIZES[at];
    this.size.value = String(at);
    this.size.setAttribute("aria-valuetext", `${at + 1} of ${SIZES.length}`);
  }

  undo() {
    this.active?.undo();
  }

  redo() {
    this.active?.redo();
  }

  keydown(event) {
    const typing = event.target.matches?.("select, input:not([type=checkbox], [type=range])");
    if (this.drawing.hidden || typing || event.altKey) return;
    const key = event.key.toLowerCase();
    if (event.ctrlKey || event.metaKey) {
      if (key === "z" && !event.shiftKey) this.undo();
      else if (key === "y" || (key === "z" && event.shiftKey)) this.redo();
      else return;
    } else if (/^[0-9]$/.test(key)) this.choose(key === "0" ? 10 : Number(key));
    else if (key === "e") this.choose(0);
    else if (key === "[") this.resize(SIZES.indexOf(this.tool.radius) - 1);
    else if (key === "]") this.resize(SIZES.indexOf(this.tool.radius) + 1);
    else return;
    event.preventDefault();
  }

  destroy() {
    document.removeEventListener("keydown", this.keys);
    for (const editor of this.editors.values()) editor.flush();
    this.live.hidden = false;
    this.style.remove();
  }
}

/** One camera's frozen picture with its brush, its own buttons and what is said of it. */
class Editor {
  constructor(name, camera, part) {
    this.name = name;
    this.part = part;
    this.asSeen = part.seen.checked;
    this.brush = new BrushCanvas(name, camera.size, part.colours, part.tool, {
      onStart: (brush) => {
        part.active = brush;
      },
      onDone: () => this.later(),
    });
    this.state = element("span", { class: "state" });
    this.note = element("p", { class: "hint-text" });
    this.root = element(
      "figure",
      { class: "strokes-picture", "data-camera": name },
      this.brush.canvas,
      element(
        "figcaption",
        {},
        element("strong", {}, name),
        this.state,
        button(`zoom-in-${name}`, "+", () => this.brush.zoomBy(1.5), {
          "aria-label": `Zoom in on ${name}`,
        }),
        button(`zoom-out-${name}`, "−", () => this.brush.zoomBy(1 / 1.5), {
          "aria-label": `Zoom out of ${name}`,
        }),
        button(`clear-${name}`, "Erase all", () => {
          part.active = this.brush;
          this.brush.clear();
        }),
      ),
      this.note,
    );
  }

  update(camera) {
    const told = JSON.stringify(camera);
    if (told === this.told) return;
    this.told = told;
    setText(this.state, camera.ok ? "Light known" : "Strokes needed");
    this.state.className = `state ${camera.ok ? "done" : "working"}`;
    setText(this.note, camera.note ? `${camera.note.charAt(0).toUpperCase()}${camera.note.slice(1)}.` : "");
    this.brush.remark(camera.marks, camera.alike);
    if (camera.picture !== this.pictureKey) {
      this.pictureKey = camera.picture;
      this.load(camera.picture, "picture");
    }
    if (camera.seen !== this.seenKey) {
      this.seenKey = camera.seen;
      if (camera.seen) this.load(camera.seen, "seenPicture");
      else this.seenPicture = null;
    }
    if (camera.strokes !== this.strokesKey) {
      this.strokesKey = camera.strokes;
      // what this page drew itself is already here, and may have been drawn on since
      if (camera.by !== this.part.me || !this.loaded) this.loadStrokes(camera.strokes);
    }
    this.draw(this.asSeen);
  }

  /** Keeps the image of a key as `this[place]`; keys that are gone are of the past. */
  async load(key, place) {
    const image = new Image();
    image.src = this.part.link.pictureUrl(key);
    try {
      await image.decode();
    } catch {
      return; // the setup went on: a newer key is on its way
    }
    if (key !== this.pictureKey && key !== this.seenKey) return;
    this[place] = image;
    this.draw(this.asSeen);
  }

  async loadStrokes(key) {
    const answer = await fetch(this.part.link.pictureUrl(key));
    if (!answer.ok || key !== this.strokesKey) return;
    const { values } = await decodeGreyPng(await answer.arrayBuffer());
    if (key !== this.strokesKey) return;
    this.loaded = true;
    this.brush.strokes.replace(values);
    this.brush.render();
  }

  draw(asSeen) {
    this.asSeen = asSeen;
    const seen = asSeen && this.seenPicture;
    this.brush.show(seen || this.picture, !seen);
  }

  later() {
    clearTimeout(this.timer);
    this.loaded = true;
    this.timer = setTimeout(() => this.send(), SEND_AFTER_MS);
  }

  /** Send what still waits. */
  flush() {
    if (this.timer) this.send();
  }

  async send() {
    clearTimeout(this.timer);
    this.timer = null;
    const { ids, width, height } = this.brush.strokes;
    const png = base64(await encodeGreyPng(ids, width, height));
    this.part.link.send("strokes", { camera: this.name, png_base64: png, by: this.part.me });
  }
}
