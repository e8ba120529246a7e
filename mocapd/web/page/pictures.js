// <camera-picture camera="cam0">: a camera's live picture with what is drawn over it.
//
// Each picture is asked for when the one before is drawn, so a slow page is never flooded; a picture
// that nobody sees is not asked for. Fires "picture" (detail: the header) on itself with each.
// Property `header`: of the picture shown, {camera, seq, t_ns, size_px, shapes}; `bitmap`: its pixels.

import { Socket } from "./link.js";
import { drawShapes, shapeColours } from "./shapes.js";

const WIDTH_STEP_PX = 160;
const LARGEST_WIDTH_PX = 480; // what looking may cost the tracker; `max-width-px` asks for more
const NO_PICTURE_PAUSE_MS = 500;

/** One connection for all pictures of the page. */
class PictureLink {
  constructor() {
    this.elements = new Set();
    this.asked = new Map(); // by camera: the elements that wait for its next picture
    this.socket = new Socket(
      "pictures",
      (event) => this.take(event.data),
      (state) => this.changed(state),
    );
  }

  changed(state) {
    this.asked.clear();
    if (state === "open") for (const element of this.elements) element.ask();
    else for (const element of this.elements) element.lost("No connection");
  }

  /** Ask for the camera's next picture; others who ask for it meanwhile get the same. */
  ask(element) {
    const waiting = this.asked.get(element.camera);
    if (waiting) {
      waiting.add(element);
      return;
    }
    const request = { camera: element.camera, width: element.askedWidth(), after: element.seq };
    if (element.hasAttribute("over")) request.over = element.getAttribute("over");
    if (this.socket.send(request)) this.asked.set(element.camera, new Set([element]));
  }

  async take(data) {
    const length = new DataView(data).getUint32(0, true);
    const header = JSON.parse(new TextDecoder().decode(new Uint8Array(data, 4, length)));
    const waiting = this.asked.get(header.camera) ?? new Set();
    this.asked.delete(header.camera);
    if (header.seq === null) {
      for (const element of waiting) element.lost(header.why);
      return;
    }
    const jpeg = new Blob([new Uint8Array(data, 4 + length)], { type: "image/jpeg" });
    const bitmap = await createImageBitmap(jpeg);
    for (const element of waiting) element.show(header, bitmap);
  }
}

let link = null; // made with the first picture that is shown

class CameraPicture extends HTMLElement {
  static observedAttributes = ["camera"];

  connectedCallback() {
    if (!this.canvas) {
      this.canvas = document.createElement("canvas");
      this.canvas.setAttribute("role", "img");
      this.note = document.createElement("p");
      this.note.className = "picture-note";
      this.append(this.canvas, this.note);
    }
    this.named();
    this.lost("Waiting for the picture");
    this.colours = shapeColours(this);
    this.onScreen = false;
    this.watcher = new IntersectionObserver((entries) => {
      this.onScreen = entries[entries.length - 1].isIntersecting;
      this.ask();
    });
    this.watcher.observe(this);
    this.awake = () => this.ask();
    document.addEventListener("visibilitychange", this.awake);
    link ??= new PictureLink();
    link.elements.add(this);
  }

  disconnectedCallback() {
    link.elements.delete(this);
    this.watcher.disconnect();
    clearTimeout(this.retry);
    document.removeEventListener("visibilitychange", this.awake);
  }

  attributeChangedCallback() {
    this.seq = null;
    if (this.canvas) this.named();
  }

  named() {
    this.camera = this.getAttribute("camera") ?? "";
    this.canvas.setAttribute("aria-label", `Live picture of ${this.camera}`);
  }

  askedWidth() {
    const most = Number(this.getAttribute("max-width-px")) || LARGEST_WIDTH_PX;
    const wanted = this.clientWidth * (window.devicePixelRatio || 1);
    const steps = Math.max(1, Math.ceil(wanted / WIDTH_STEP_PX));
    return Math.min(most, steps * WIDTH_STEP_PX);
  }

  ask() {
    clearTimeout(this.retry);
    if (this.isConnected && this.onScreen && document.visibilityState === "visible") link.ask(this);
  }

  show(header, bitmap) {
    this.header = header;
    this.bitmap = bitmap;
    this.seq = header.seq;
    this.note.hidden = true;
    this.classList.remove("lost");
    const [width, height] = header.size_px;
    this.draw(width, height);
    this.dispatchEvent(new CustomEvent("picture", { detail: header }));
    requestAnimationFrame(() => this.ask());
  }

  draw(width, height) {
    // shapes are drawn as fine as the screen is, whatever the picture's own width
    const unit = window.devicePixelRatio || 1;
    const across = Math.max(1, Math.round((this.clientWidth || width) * unit));
    const down = Math.max(1, Math.round((across * height) / width));
    if (this.canvas.width !== across || this.canvas.height !== down) {
      this.canvas.width = across;
      this.canvas.height = down;
    }
    const context = this.canvas.getContext("2d");
    context.drawImage(this.bitmap, 0, 0, across, down);
    drawShapes(context, this.header.shapes, this.colours, across / width, unit);
  }

  lost(why) {
    this.seq = null;
    this.note.hidden = false;
    this.note.textContent = why.charAt(0).toUpperCase() + why.slice(1);
    this.classList.add("lost");
    clearTimeout(this.retry);
    this.retry = setTimeout(() => this.ask(), NO_PICTURE_PAUSE_MS);
  }
}

customElements.define("camera-picture", CameraPicture);
