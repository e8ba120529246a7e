// The step Body: the stature is typed, the proportions are measured and shown against the picture.

import { button, element, setText } from "./setup.js";

export const title = "Body";

const CM_PER_INCH = 2.54;

export class StepPart {
  constructor(root, link) {
    this.root = root;
    this.link = link;
    this.style = element("link", { rel: "stylesheet", href: new URL("step_body.css", import.meta.url).href });
    document.head.append(this.style);
    this.cm = number("stature-cm", 80, 230, "175");
    this.feet = number("stature-ft", 2, 7, "5");
    this.inches = number("stature-in", 0, 11.9, "9");
    this.metric = element("span", {}, element("label", {}, this.cm, "cm"));
    this.imperial = element(
      "span",
      { class: "feet" },
      element("label", {}, this.feet, "ft"),
      element("label", {}, this.inches, "in"),
    );
    this.imperial.hidden = true;
    this.unit = element(
      "select",
      { id: "stature-unit", "aria-label": "Unit of the stature" },
      element("option", { value: "cm" }, "centimetres"),
      element("option", { value: "ft" }, "feet and inches"),
    );
    this.unit.addEventListener("change", () => this.showUnit());
    const form = element(
      "form",
      { class: "stature" },
      element("strong", {}, "My height"),
      this.metric,
      this.imperial,
      this.unit,
      element("button", { type: "submit", id: "stature-ok", "data-action": "stature" }, "Use this height"),
    );
    form.noValidate = true; // the service tells what is wrong, where all trouble is told
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      this.send();
    });
    this.measure = button("measure", "Measure", () => this.link.send("measure"), {
      id: "measure",
      class: "primary",
    });
    this.skip = button("skip", "Use my height alone", () => this.link.send("skip"), { id: "skip" });
    this.table = element("table", { id: "lengths", class: "lengths" });
    this.pictures = element("div", { class: "body-pictures" });
    this.measuring = element("div", { class: "measure" }, this.measure, this.skip);
    this.lead = [this.measuring];
    root.replaceChildren(
      form,
      this.table,
      this.pictures,
    );
  }

  showUnit() {
    const feet = this.unit.value === "ft";
    const cm = this.typedCm(!feet);
    this.metric.hidden = feet;
    this.imperial.hidden = !feet;
    if (Number.isFinite(cm)) this.fill(cm);
  }

  typedCm(metric) {
    if (metric) return this.cm.value === "" ? NaN : Number(this.cm.value);
    if (this.feet.value === "") return NaN;
    return CM_PER_INCH * (12 * Number(this.feet.value) + Number(this.inches.value || 0));
  }

  fill(cm) {
    const inches = Math.round((2 * cm) / CM_PER_INCH) / 2;
    this.cm.value = String(Math.round(10 * cm) / 10);
    this.feet.value = String(Math.floor(inches / 12));
    this.inches.value = String(inches % 12);
  }

  send() {
    const cm = this.typedCm(this.unit.value === "cm");
    this.link.send("stature", { m: Number.isFinite(cm) ? Math.round(10 * cm) / 1000 : null });
  }

  update(view) {
    const details = view.details;
    if (details.stature_m !== this.stature) {
      this.stature = details.stature_m;
      if (this.stature !== null) this.fill(100 * this.stature);
    }
    this.measuring.hidden = !details.has_shirt; // from which alone proportions are read
    this.measure.disabled = !details.can_measure || details.measuring;
    this.measure.title = details.why_not;
    setText(this.measure, details.measured ? "Measure again" : "Measure");
    this.measure.classList.toggle("primary", !details.measured); // then "Next" is the one to press
    this.skip.disabled = details.stature_m === null;
    this.drawLengths(details);
    const told = details.pictures.join("\n");
    if (told !== this.shown) {
      this.shown = told;
      this.pictures.replaceChildren(
        ...details.pictures.map((key) =>
          element("img", {
            src: this.link.pictureUrl(key),
            alt: "The measured body drawn over the picture",
          }),
        ),
      );
    }
  }

  drawLengths(details) {
    const told = JSON.stringify([details.lengths_cm, details.measured]);
    if (told === this.lengths) return;
    this.lengths = told;
    const names = Object.keys(details.lengths_cm);
    this.table.hidden = names.length === 0;
    const header = details.measured
      ? ["between joints", "measured", "usual for your height"]
      : ["between joints", "usual for your height"];
    const rows = names.map((name) => {
      const usual = `${details.usual_cm[name].toFixed(0)} cm`;
      const cells = details.measured ? [`${details.lengths_cm[name].toFixed(1)} cm`, usual] : [usual];
      return element(
        "tr",
        {},
        element("th", { scope: "row" }, name),
        ...cells.map((text) => element("td", {}, text)),
      );
    });
    this.table.replaceChildren(
      element("thead", {}, element("tr", {}, ...header.map((text) => element("th", { scope: "col" }, text)))),
      element("tbody", {}, ...rows),
    );
  }

  destroy() {
    this.style.remove();
  }
}

function number(id, min, max, placeholder) {
  return element("input", {
    type: "number",
    id,
    min: String(min),
    max: String(max),
    step: "any",
    inputmode: "decimal",
    placeholder,
  });
}
