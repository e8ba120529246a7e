// A line plot of the last minute, on a canvas; its newest values are also text, for everybody.

const SPAN_S = 60;
const PAD = { left: 40, right: 8, top: 8, bottom: 20 }; // CSS px, as all below

export class Plot {
  /** series: [{name, style}], style a CSS variable's name; unit: written at the scale. */
  constructor(root, title, unit, series) {
    this.unit = unit;
    this.series = series.map((one) => ({ ...one, values: [] })); // of [time s, value or null]
    this.figure = document.createElement("figure");
    this.figure.className = "plot";
    const caption = document.createElement("figcaption");
    caption.append(`${title} `);
    for (const one of this.series) {
      one.legend = document.createElement("span");
      one.legend.className = `legend ${one.style}`;
      caption.append(one.legend);
    }
    this.canvas = document.createElement("canvas");
    this.canvas.setAttribute("aria-hidden", "true"); // the legend has the numbers
    this.figure.append(caption, this.canvas);
    root.append(this.figure);
    this.resized = new ResizeObserver(() => this.draw());
    this.resized.observe(this.canvas);
  }

  /** The values of all series at a time [s]; null where there is none. */
  add(time_s, values) {
    this.now_s = time_s;
    this.series.forEach((one, i) => {
      const value = Number.isFinite(values[i]) ? values[i] : null;
      one.values.push([time_s, value]);
      while (one.values[0][0] < time_s - SPAN_S) one.values.shift();
      const shown = value === null ? "–" : value.toFixed(1);
      one.legend.textContent = `${one.name} ${shown} ${this.unit}`;
    });
    this.draw();
  }

  draw() {
    const unit = window.devicePixelRatio || 1;
    const width = this.canvas.clientWidth;
    const height = this.canvas.clientHeight;
    if (width === 0 || this.now_s === undefined) return;
    this.canvas.width = Math.round(width * unit);
    this.canvas.height = Math.round(height * unit);
    const context = this.canvas.getContext("2d");
    context.scale(unit, unit);
    const css = getComputedStyle(this.canvas);
    const top = this.top();
    const x = (time_s) =>
      PAD.left + (1 - (this.now_s - time_s) / SPAN_S) * (width - PAD.left - PAD.right);
    const y = (value) => height - PAD.bottom - (value / top) * (height - PAD.top - PAD.bottom);
    this.drawScale(context, css, top, x, y);
    for (const one of this.series) {
      context.strokeStyle = css.getPropertyValue(`--${one.style}`).trim();
      context.lineWidth = 2;
      context.beginPath();
      let pen = false;
      for (const [time_s, value] of one.values) {
        if (value !== null) {
          if (pen) context.lineTo(x(time_s), y(value));
          else context.moveTo(x(time_s), y(value));
        }
        pen = value !== null;
      }
      context.stroke();
    }
  }

  drawScale(context, css, top, x, y) {
    context.font = "12px system-ui, sans-serif";
    context.fillStyle = css.getPropertyValue("--text-soft").trim();
    context.strokeStyle = css.getPropertyValue("--line").trim();
    context.lineWidth = 1;
    context.textAlign = "right";
    context.textBaseline = "middle";
    for (const share of [0, 0.5, 1]) {
      const at = Math.round(y(share * top)) + 0.5;
      context.beginPath();
      context.moveTo(PAD.left, at);
      context.lineTo(x(this.now_s), at);
      context.stroke();
      context.fillText(String(share * top), PAD.left - 6, at);
    }
    context.textBaseline = "bottom";
    for (const ago_s of [60, 30, 0]) {
      context.textAlign = ago_s === 60 ? "left" : ago_s === 0 ? "right" : "center";
      const word = ago_s === 0 ? "now" : `${ago_s} s ago`;
      context.fillText(word, x(this.now_s - ago_s), this.canvas.clientHeight);
    }
  }

  /** The top of the scale: a round number not below any value. */
  top() {
    const most = Math.max(1, ...this.series.flatMap((one) => one.values.map(([, v]) => v ?? 0)));
    const power = 10 ** Math.floor(Math.log10(most));
    return [1, 2, 4, 6, 10].map((step) => step * power).find((step) => step >= most);
  }

  destroy() {
    this.resized.disconnect();
    this.figure.remove();
  }
}
