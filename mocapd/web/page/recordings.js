// Record and stop, and the recordings that were made: name, length, notes, download, export.

import { button, element, setText } from "./setup.js";

const PLACE = new URL("../", import.meta.url);
const LOOK_EVERY_MS = 1000;

export class RecordingsPart {
  constructor(root, onTrouble) {
    this.onTrouble = onTrouble;
    this.record = button("record", "Record", () => this.toggle(), { id: "record", class: "primary" });
    this.now = element("span", { id: "recording-now", class: "state failed", role: "status", hidden: true });
    this.heading = element("h2", {}, "Recordings");
    this.folder = element("p", { class: "soft" });
    this.list = element("div", { id: "recordings", class: "recordings" });
    this.root = element("section", { "aria-label": "Recordings", hidden: true }, this.heading, this.folder, this.list);
    root.append(this.root);
    this.rows = new Map();
    this.timer = setInterval(() => this.isRecording && this.look(), LOOK_EVERY_MS);
    this.look();
  }

  /** The buttons for the top of the page. */
  get buttons() {
    return [this.record, this.now];
  }

  async look() {
    const answer = await fetch(new URL("recordings", PLACE)).catch(() => null);
    if (answer?.ok) this.draw(await answer.json());
    else this.record.disabled = true; // a setup by itself has none
  }

  toggle() {
    return this.ask({ verb: this.isRecording ? "stop" : "start" });
  }

  /** Does something, and draws what there is then. */
  async ask(request) {
    const answer = await post("recordings", request);
    if (!answer) return;
    const told = await answer.json();
    if (answer.ok) this.draw(told);
    else this.onTrouble(`${told.where}: ${told.what}. ${told.fix}`);
  }

  draw({ folder, now, recordings, formats }) {
    this.record.disabled = false;
    this.isRecording = now !== null;
    setText(this.record, this.isRecording ? "Stop recording" : "Record");
    this.record.setAttribute("aria-pressed", String(this.isRecording));
    this.now.hidden = !this.isRecording;
    if (now) setText(this.now, now.trouble || `Recording ${length(now.length_s)}, ${now.frames} frames`);
    this.root.hidden = recordings.length === 0;
    setText(this.folder, `In ${folder}; files of the same kind as those of mocapd record.`);
    const ids = recordings.map((one) => one.id).join();
    if (ids !== this.ids) {
      this.ids = ids;
      this.rows = new Map(recordings.map((one) => [one.id, new Row(one, formats, this)]));
      this.list.replaceChildren(...[...this.rows.values()].map((row) => row.root));
    }
    for (const one of recordings) this.rows.get(one.id).update(one);
  }

  destroy() {
    clearInterval(this.timer);
  }
}

class Row {
  constructor(one, formats, part) {
    const field = (id, words, value, longest) => {
      const input = element("input", { id: `${id}-${one.id}`, maxlength: longest, autocomplete: "off", placeholder: words });
      input.value = value;
      input.setAttribute("aria-label", `${words} of the recording of ${when(one.id)}`);
      const send = () => part.ask({ verb: "note", id: one.id, name: this.name.value, notes: this.notes.value });
      input.addEventListener("change", send);
      return input;
    };
    this.name = field("name", "Name", one.name, "80");
    this.notes = field("notes", "Notes", one.notes, "2000");
    this.length = element("span", { class: "soft" });
    const address = (...parts) => new URL(["recordings", one.id, ...parts].join("/"), PLACE).href;
    const download = element("a", { class: "button", href: address(), download: "" }, "Download");
    const format = element(
      "select",
      { "aria-label": `Export the recording of ${when(one.id)} as` },
      element("option", { value: "" }, "Export as …"),
      ...formats.map((name) => element("option", { value: name }, name.toUpperCase())),
    );
    format.addEventListener("change", () => this.export(part, address(format.value), format));
    this.root = element(
      "div",
      { class: "panel recording", "data-id": one.id },
      element("strong", {}, when(one.id)),
      this.length,
      this.name,
      this.notes,
      download,
      format,
    );
  }

  update(one) {
    const lasts = one.length_s === null ? "not ended in order" : length(one.length_s);
    setText(this.length, `${lasts}, ${(one.size_bytes / 1e6).toFixed(1)} MB`);
  }

  async export(part, address, format) {
    if (!format.value) return;
    format.disabled = true;
    try {
      const answer = await fetch(address).catch(() => null);
      if (answer?.ok) {
        const name = /filename="(.+)"/.exec(answer.headers.get("content-disposition"))?.[1] ?? "export";
        const link = element("a", { href: URL.createObjectURL(await answer.blob()), download: name });
        link.click();
        URL.revokeObjectURL(link.href);
      } else if (answer) {
        const told = await answer.json();
        part.onTrouble(`${told.where}: ${told.what}. ${told.fix}`);
      }
    } finally {
      format.disabled = false;
      format.value = "";
    }
  }
}

/** POST with JSON; null without a connection. */
export function post(name, message = {}) {
  const init = { method: "POST", headers: { "content-type": "application/json" }, body: JSON.stringify(message) };
  return fetch(new URL(name, PLACE), init).catch(() => null);
}

/** 20261126-183000 as a date and a time. */
function when(id) {
  return `${id.slice(0, 4)}-${id.slice(4, 6)}-${id.slice(6, 8)} ${id.slice(9, 11)}:${id.slice(11, 13)}:${id.slice(13)}`;
}

function length(seconds) {
  const whole = Math.round(seconds);
  return `${Math.floor(whole / 60)}:${String(whole % 60).padStart(2, "0")}`;
}
