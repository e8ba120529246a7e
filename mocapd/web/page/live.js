// The live view: every camera, the body in 3D, how quick everything is, and who listens.

import { Socket } from "./link.js";
import { Plot } from "./plots.js";
import { RecordingsPart, post } from "./recordings.js";
import { button } from "./setup.js";
import { StickFigure } from "./stick_figure.js";

const TRACKING = {
  live: ["Tracking", "done"],
  coasting: ["Lost sight, guessing on", "working"],
  lost: ["Nobody is seen", "waiting"],
};
const CAMERA_STATES = { live: "done", opening: "working", lost: "failed", ended: "waiting" };

function tracking(figures) {
  if (figures.slowness) return [capital(mended(figures.slowness)), "failed"];
  if (figures.tracking === "lost" && figures.lost_reason) {
    return [`Nobody is tracked: ${figures.lost_reason}`, "working"];
  }
  return TRACKING[figures.tracking] ?? [figures.tracking, "waiting"];
}

function mended(text) {
  return text.replace(" -- ", ". Mend: ");
}

export class Live {
  constructor(root) {
    this.root = root;
    root.replaceChildren();
    const heading = make(root, "h1", "", "Live view");
    heading.id = "live-title";
    const head = make(root, "p", "step-head");
    this.tracking = make(head, "span", "state");
    this.tracking.setAttribute("role", "status");
    this.tracking.id = "tracking";
    this.summary = make(head, "span", "summary");
    this.preparing = make(root, "p", "soft");
    this.preparing.id = "preparing";
    this.preparing.hidden = true;
    this.trouble = make(root, "p", "problem bad");
    this.trouble.setAttribute("role", "alert");
    this.trouble.hidden = true;
    this.moved = make(root, "div", "problem bad");
    this.moved.id = "camera-moved";
    this.moved.hidden = true;
    const controls = make(root, "div", "row controls");
    const stage = make(root, "div", "stage");
    this.pictures = make(stage, "div", "cameras");
    this.figure = new StickFigure(make(stage, "div", "figure-3d"));
    const plots = make(root, "div", "plots");
    this.plots = [
      new Plot(plots, "Rate", "Hz", [{ name: "poses", style: "plot-a" }]),
      new Plot(plots, "Latency", "ms", [
        { name: "median", style: "plot-a" },
        { name: "95 %", style: "plot-b" },
      ]),
    ];
    make(root, "h2", "", "Cameras");
    this.cameras = table(root, [
      "Camera",
      "State",
      "Rate",
      "Frames",
      "Damaged",
      "Reopened",
      "Why",
    ]);
    this.cameras.id = "live-cameras";
    make(root, "h2", "", "Who listens");
    this.outputs = table(root, ["Output", "Listeners", "Sent", "Not sent", "Details"]);
    this.outputs.id = "live-outputs";
    this.recordings = new RecordingsPart(root, (text) => this.say(text));
    this.mirrored = button("mirror", "Mirror", () => this.mirror(), { id: "mirror", "aria-pressed": "false" });
    controls.append(
      ...this.recordings.buttons,
      button("recenter", "Recenter", () => this.recenter(), { id: "recenter", title: "What you face now is forward" }),
      this.mirrored,
      button("full-screen", "Full screen", () => fullScreen(stage), {
        id: "full-screen",
        hidden: !document.fullscreenEnabled, // some phones show videos alone that way
      }),
    );
    this.socket = new Socket(
      "live",
      (event) => this.take(JSON.parse(event.data)),
      (state) => state === "open" && this.watch(),
    );
    this.watch = () => this.socket?.send({ watch: document.visibilityState === "visible" });
    document.addEventListener("visibilitychange", this.watch);
  }

  take(message) {
    if (message.kind === "scene") this.scene(message);
    else if (message.kind === "body") this.figure.setBody(message);
    else this.figures(message.figures);
  }

  /** Trouble with what was pressed, until something else is. */
  say(text) {
    this.trouble.hidden = !text;
    this.trouble.textContent = text;
  }

  async recenter() {
    const answer = await post("recenter");
    const told = answer?.ok === false ? await answer.json() : null;
    this.say(told ? `${told.where}: ${told.what}. ${told.fix}` : "");
  }

  /** As in a mirror: who moves to the left sees that on the left. */
  mirror() {
    const on = this.mirrored.getAttribute("aria-pressed") !== "true";
    this.mirrored.setAttribute("aria-pressed", String(on));
    this.pictures.classList.toggle("mirrored", on);
  }

  /** Cameras that were turned or exchanged, with the way to mend it. */
  drawMoved(cameras) {
    const moved = cameras.filter((one) => one.bumped || one.swapped);
    this.moved.hidden = moved.length === 0;
    const words = moved.map((one) => `${one.name} ${one.swapped ? "shows what another camera should" : "was moved"}`);
    const text = `${words.join(", ")}. Put it back, or measure the room anew. `;
    if (moved.length === 0 || this.moved.dataset.text === text) return;
    this.moved.dataset.text = text;
    this.moved.replaceChildren(text, button("room-anew", "Measure the room", () => this.roomAnew(), { id: "room-anew" }));
  }

  async roomAnew() {
    const answer = await post("setup", { step: "room" });
    const told = answer ? await answer.json() : { what: "" };
    if (told.what) this.say(`${told.where}: ${told.what}. ${told.fix}`);
    else location.hash = "#setup";
  }

  scene(scene) {
    this.figure.setScene(scene);
    const shown = [...this.pictures.querySelectorAll("camera-picture")];
    if (shown.map((one) => one.getAttribute("camera")).join("\n") === scene.names.join("\n")) return;
    const columns = scene.names.length > 3 ? 2 : 1; // of the full screen
    this.pictures.style.setProperty("--columns", columns);
    this.pictures.style.setProperty("--rows", Math.ceil(scene.names.length / columns));
    this.pictures.replaceChildren();
    for (const name of scene.names) {
      const figure = make(this.pictures, "figure", "camera");
      const picture = make(figure, "camera-picture");
      picture.setAttribute("over", "body"); // also while a setup draws over its own pictures
      picture.setAttribute("camera", name);
      make(figure, "figcaption", "", name);
    }
  }

  figures(figures) {
    this.preparing.hidden = !figures?.preparing;
    this.preparing.textContent = figures?.preparing
      ? `Tracking gets better when all is prepared: ${figures.preparing}.`
      : "";
    if (figures === null) {
      this.state("Nothing is tracked now", "waiting", "");
      this.figure.setBody(null);
      return;
    }
    const latency = figures.latency_ms;
    this.state(
      ...tracking(figures),
      `tracker ${figures.tracker || "–"}, ${number(figures.rate_hz)} poses a second, ` +
        `${number(latency.median)} ms from light to output` +
        (figures.lag_ms.median === null ? "" : ` and ${number(figures.lag_ms.median)} ms of smoothing`) +
        `, step ${number(figures.step_ms.median)} ms, ` +
        `${figures.sets_dropped} of ${figures.sets_made} frame sets skipped` +
        (figures.effort && !figures.slowness ? `; ${mended(figures.effort)}` : ""), // the remedy is said once
    );
    const now_s = performance.now() / 1000;
    this.plots[0].add(now_s, [figures.rate_hz]);
    this.plots[1].add(now_s, [latency.median, latency.p95]);
    this.drawMoved(figures.cameras);
    rows(
      this.cameras,
      figures.cameras.map((one) => [
        one.name,
        one.bumped || one.swapped
          ? { text: one.swapped ? "swapped" : "bumped", look: "state failed" }
          : { text: one.state, look: `state ${CAMERA_STATES[one.state] ?? ""}` },
        `${number(one.fps_hz)} Hz`,
        String(one.frames),
        String(one.torn),
        String(one.reopens),
        one.swapped
          ? "It shows what another camera should: exchange them, or do the setup's step Room again."
          : one.bumped
            ? "It was turned: put it back, or do the setup's step Room again."
            : one.reason,
      ]),
    );
    rows(
      this.outputs,
      figures.outputs.map((one) => [
        one.name,
        one.listeners < 0 ? "unknown" : String(one.listeners),
        String(one.sent),
        String(one.refused),
        one.detail,
      ]),
    );
  }

  state(text, look, summary) {
    if (this.tracking.textContent !== text) this.tracking.textContent = text;
    this.tracking.className = `state ${look}`;
    this.summary.textContent = summary;
  }

  destroy() {
    document.removeEventListener("visibilitychange", this.watch);
    this.socket.close();
    this.figure.destroy();
    this.recordings.destroy();
    for (const plot of this.plots) plot.destroy();
    this.root.replaceChildren();
  }
}

function capital(text) {
  return text.charAt(0).toUpperCase() + text.slice(1);
}

function fullScreen(stage) {
  if (document.fullscreenElement) document.exitFullscreen();
  else stage.requestFullscreen();
}

function number(value) {
  return value === null || value === undefined ? "–" : value.toFixed(1);
}

function make(parent, tag, look = "", text = "") {
  const made = document.createElement(tag);
  if (look) made.className = look;
  made.textContent = text;
  parent.append(made);
  return made;
}

function table(root, heads) {
  const place = make(root, "div", "table-place"); // scrolls by itself on a narrow screen
  place.tabIndex = 0;
  const made = make(place, "table");
  const head = make(make(made, "thead"), "tr");
  for (const one of heads) make(head, "th", "", one).scope = "col";
  make(made, "tbody");
  return made;
}

/** Fills a table; cells are texts or {text, look}, the first of a row is its head. */
function rows(of, all) {
  const body = of.tBodies[0];
  while (body.rows.length > all.length) body.deleteRow(-1);
  all.forEach((cells, i) => {
    const row = body.rows[i] ?? body.insertRow();
    cells.forEach((cell, j) => {
      if (!row.cells[j]) row.append(document.createElement(j === 0 ? "th" : "td"));
      const { text, look = "" } = typeof cell === "string" ? { text: cell } : cell;
      let at = row.cells[j];
      if (j === 0) at.scope = "row";
      if (look) {
        at = at.firstElementChild ?? make(at, "span");
        at.className = look;
      }
      if (at.textContent !== text) at.textContent = text;
    });
  });
}
