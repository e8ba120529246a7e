// The step Lens: the board's form, and how far each camera has come.

import { button, element, setText } from "./setup.js";

export const title = "Lens";

const KINDS = { charuco: "ChArUco (squares with markers)", chessboard: "Plain chessboard" };

export class StepPart {
  constructor(root, link, cameras) {
    this.link = link;
    this.rows = new Map(); // by camera
    this.board = new BoardForm(link);
    this.note = element("p", { id: "board-note", class: "soft", role: "status" });
    this.body = element("tbody");
    this.finish = button("finish", "Finish with these lenses", () => link.send("finish"), {
      id: "finish",
    });
    this.useAll = button("use-saved-all", "Use all saved lenses", () => link.send("use_saved"), {
      id: "use-saved-all",
    });
    this.lead = [this.finish];
    root.append(
      element(
        "div",
        { class: "table-place" },
        element(
          "table",
          { id: "lenses" },
          element("caption", { class: "visually-hidden" }, "The lens of each camera"),
          element("thead", {}, headings("Camera", "Pictures", "Seen", "Error", "Held out", "Focal length")),
          this.body,
        ),
      ),
      element("div", { class: "row" }, this.useAll),
      this.note,
      boardPicture("board_views.svg", "How to hold the board: turned to one camera at a time, near and far, in the middle and at every edge, tilted to each side", [
        [0, 0, 315, 142],
        [315, 0, 315, 142],
      ]),
      this.board.root,
    );
    this.cameras = cameras;
  }

  update(view) {
    const details = view.details;
    if (!details.cameras) return;
    this.board.update(details.board);
    setText(this.note, details.note ?? "");
    let offers = 0;
    for (const [id, camera] of Object.entries(details.cameras)) {
      if (!this.rows.has(id)) {
        const row = new LensRow(id, this.link);
        this.rows.set(id, row);
        this.body.append(row.root);
      }
      this.rows.get(id).update(camera);
      if (camera.offered && !camera.lens) offers += 1;
    }
    this.finish.hidden = view.state === "done" || !details.finishable;
    this.useAll.hidden = offers < 2;
  }

  destroy() {}
}

/** One camera in the table. */
class LensRow {
  constructor(id, link) {
    this.cells = Array.from({ length: 5 }, () => element("td"));
    this.name = element("span");
    this.use = button("use-saved", "", () => link.send("use_saved", { camera: id }), {
      "data-camera": id,
    });
    this.measure = button("measure", "Measure anew", () => link.send("measure", { camera: id }), {
      "data-camera": id,
    });
    this.root = element(
      "tr",
      { "data-camera": id },
      // the buttons beside the name: on a phone the figures are out of sight to the right
      element("th", { scope: "row" }, this.name, element("div", {}, this.use, this.measure)),
      ...this.cells,
    );
  }

  update(camera) {
    const lens = camera.lens ?? camera.so_far;
    setText(this.name, camera.name + (camera.lens ? " ✓" : ""));
    const texts = [
      camera.taken ? "saved" : String(camera.views),
      camera.taken ? "" : `${Math.round(100 * camera.covered)} %`,
      lens && lens.rms_px !== null ? `${lens.rms_px.toFixed(2)} px` : "",
      lens && lens.held_out_px !== null ? `${lens.held_out_px.toFixed(2)} px` : "",
      lens && lens.focal_percent !== null ? `± ${lens.focal_percent.toFixed(2)} %` : "",
    ];
    texts.forEach((text, i) => setText(this.cells[i], text));
    this.use.hidden = !camera.offered || Boolean(camera.lens);
    this.measure.hidden = !camera.taken;
    if (camera.offered) {
      const when = camera.offered.when ? ` of ${camera.offered.when}` : "";
      setText(this.use, `Use the saved lens${when}`);
    }
  }
}

/** What is printed on the board; sent when it is changed. */
class BoardForm {
  constructor(link) {
    this.link = link;
    this.told = "";
    this.kind = select("board-kind", Object.entries(KINDS));
    this.dictionary = select("board-dictionary", []);
    this.columns = number("board-columns", 3, 100, 1);
    this.rows = number("board-rows", 3, 100, 1);
    this.square = number("board-square", 1, 999, 0.01);
    this.marker = number("board-marker", 0, 999, 0.01);
    this.inverted = element("input", { type: "checkbox", id: "board-inverted" });
    this.legacy = element("input", { type: "checkbox", id: "board-legacy" });
    this.twoSided = element("input", { type: "checkbox", id: "board-two-sided" });
    this.ruler = number("ruler", 50, 150, 0.1);
    this.ruler.value = "100";
    this.form = element(
      "form",
      { id: "board-form", class: "row" },
      labelled("Kind", this.kind),
      labelled("Columns of squares", this.columns),
      labelled("Rows of squares", this.rows),
      labelled("Square [mm]", this.square),
      (this.markerLabel = labelled("Marker [mm]", this.marker)),
      (this.dictionaryLabel = labelled("Dictionary", this.dictionary)),
      labelled("Light on dark", this.inverted),
      (this.legacyLabel = labelled("Layout before OpenCV 4.6", this.legacy)),
      (this.twoSidedLabel = labelled("On both sides, mirrored on the back", this.twoSided)),
      element("button", { type: "submit", "data-action": "set-board", id: "set-board" }, "Set the board"),
    );
    this.form.addEventListener("submit", (event) => {
      event.preventDefault();
      this.send();
    });
    this.kind.addEventListener("change", () => this.showMarkers());
    const rulerForm = element(
      "form",
      { id: "ruler-form", class: "row" },
      labelled("Measure the board's ruler. How many millimetres is the line of 100 mm?", this.ruler),
      element("button", { type: "submit", "data-action": "set-ruler", id: "set-ruler" }, "Set the scale"),
    );
    rulerForm.addEventListener("submit", (event) => {
      event.preventDefault();
      if (this.ruler.value !== "") link.send("ruler", { mm: Number(this.ruler.value) });
      this.ruler.value = "100"; // what is set is in the square's length now
    });
    this.summary = element("summary", {});
    this.root = element(
      "details",
      { class: "panel", id: "board" },
      this.summary,
      element(
        "p",
        { class: "soft" },
        "Print one with: ",
        element("code", {}, "mocapd board --out board.pdf"),
        "; for cameras all around you add ",
        element("code", {}, "--two-sided"),
        ".",
      ),
      this.form,
      rulerForm,
    );
  }

  update(board) {
    const told = JSON.stringify(board);
    if (told === this.told) return; // what is being typed stays
    this.told = told;
    this.shown = board;
    const kind = board.kind === "charuco" ? "ChArUco board" : "Chessboard";
    this.summary.textContent =
      `Your board: ${kind}, ${board.columns} x ${board.rows} squares of ${board.square_mm} mm` +
      (board.inverted ? ", light on dark" : "") +
      (board.two_sided ? ", on both sides" : "");
    fill(this.dictionary, board.dictionaries.map((name) => [name, name]));
    this.kind.value = board.kind;
    this.columns.value = board.columns;
    this.rows.value = board.rows;
    this.square.value = board.square_mm;
    this.marker.value = board.marker_mm;
    this.dictionary.value = board.dictionary;
    this.inverted.checked = board.inverted;
    this.legacy.checked = board.legacy;
    this.twoSided.checked = board.two_sided;
    this.showMarkers();
  }

  showMarkers() {
    const plain = this.kind.value === "chessboard";
    for (const count of [this.columns, this.rows]) {
      count.min = this.shown.fewest[this.kind.value];
      count.max = this.shown.most;
    }
    const ofMarkers = [this.markerLabel, this.dictionaryLabel, this.legacyLabel, this.twoSidedLabel];
    for (const label of ofMarkers) {
      label.hidden = plain;
    }
  }

  send() {
    const shown = this.shown;
    const args = {
      kind: this.kind.value,
      columns: Number(this.columns.value),
      rows: Number(this.rows.value),
      dictionary: this.dictionary.value,
      inverted: this.inverted.checked,
      legacy: this.legacy.checked,
      // a plain board looks the same from both sides
      two_sided: this.twoSided.checked && this.kind.value === "charuco",
    };
    // lengths are shown rounded: only what was typed is sent
    if (Number(this.square.value) !== shown.square_mm) args.square_mm = Number(this.square.value);
    if (Number(this.marker.value) !== shown.marker_mm) args.marker_mm = Number(this.marker.value);
    this.link.send("board", args);
  }
}

/** A drawing of what to do, one of the page's files. parts: boxes of it [x, y, width, height], which stand below each
 * other on a narrow screen, where the whole would be too small to read. */
export function boardPicture(file, words, parts = []) {
  const src = new URL(file, import.meta.url).href;
  const whole = element("img", { src, alt: words });
  const images = parts.map((box, index) => {
    const part = element("img", { src: `${src}#svgView(viewBox(${box.join(",")}))`, alt: index ? "" : words });
    part.style.aspectRatio = `${box[2]} / ${box[3]}`;
    return part;
  });
  const shown = element("div", { class: "how-parts" }, ...(images.length ? images : [whole]));
  return element("figure", { class: "how" }, shown, element("figcaption", {}, words));
}

function headings(...texts) {
  return element("tr", {}, ...texts.map((text) => element("th", { scope: "col" }, text)));
}

function labelled(text, control) {
  return element("label", {}, text, control);
}

function number(id, min, max, step) {
  return element("input", { type: "number", id, min, max, step, required: true });
}

function select(id, options) {
  const made = element("select", { id });
  fill(made, options);
  return made;
}

function fill(node, options) {
  if (node.options.length === options.length) return;
  node.replaceChildren(...options.map(([value, text]) => element("option", { value }, text)));
}
