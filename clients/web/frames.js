// The connection to a running mocapd: frames as they come, and in words how it fares. It comes back by itself.
//
//   const frames = new Frames(address, { onRest, onFrame, onState, onIgnored });
//   onState({ name, text }): connecting, live, nobody, slow, quiet, unreachable or unusable, when it changes
//   onIgnored(count, why): messages that could not be used
//   frames.close();

import { read, SKELETON } from "./messages.js";

const QUIET_MS = 2000; // a daemon says at least once a second that nobody is there
const LOOK_EVERY_MS = 250;
const RETRY_MS = 1000;

export class Frames {
  constructor(address, { onRest = () => {}, onFrame = () => {}, onState = () => {}, onIgnored = () => {} }) {
    this.address = address;
    this.told = { onRest, onFrame, onState, onIgnored };
    this.ignored = 0;
    this.state = "";
    this.text = "";
    this.slowness = ""; // why tracking is too slow
    this.closed = false;
    this.heardMs = performance.now();
    this.watch = setInterval(() => this.#look(), LOOK_EVERY_MS);
    this.#connect();
  }

  close() {
    this.closed = true;
    clearInterval(this.watch);
    clearTimeout(this.retry);
    this.socket.close();
  }

  #connect() {
    const { host } = new URL(this.address);
    if (this.state !== "unreachable") this.#say("connecting", `Connecting to mocapd at ${host} …`);
    this.socket = new WebSocket(this.address);
    this.socket.onopen = () => {
      this.heardMs = performance.now();
      this.slowness = ""; // the daemon says it anew
    };
    this.socket.onmessage = ({ data }) => this.#hear(data);
    this.socket.onclose = () => {
      if (this.closed) return;
      // a browser does not tell a page why it was refused
      this.#say(
        "unreachable",
        `No frames from ${host}. Is mocapd running? Is ${location.origin} in its web.allow_origins? `
          + "Is the link the one that `mocapd web-link` prints now? Trying again.",
      );
      this.retry = setTimeout(() => this.#connect(), RETRY_MS);
    };
  }

  #hear(data) {
    const { frame, rest, slowness, ignored, version } = read(data);
    if (version !== undefined) {
      this.heardMs = performance.now();
      this.#say("unusable", `This mocapd speaks ${version}, the page reads ${SKELETON}: bring both to the same version.`);
    } else if (ignored !== undefined) {
      this.#ignore(ignored);
    } else if (rest !== undefined) {
      this.told.onRest(rest);
    } else if (slowness !== undefined) {
      this.slowness = slowness;
    } else if (frame !== undefined) {
      this.heardMs = performance.now();
      this.socket.send(JSON.stringify({ seen: frame.seq })); // so that none waits in a buffer while we are slow
      if (frame.broken > 0) this.#ignore(`${frame.broken} joints of a frame are no numbers`);
      if (this.slowness) this.#say("slow", `Tracking is slow. It is ${this.slowness}.`);
      else if (frame.joints.size > 0) this.#say("live", "Frames are coming.");
      else this.#say("nobody", "Nobody is seen.");
      this.told.onFrame(frame);
    }
  }

  #ignore(why) {
    this.ignored += 1;
    this.told.onIgnored(this.ignored, why);
  }

  #look() {
    const quietMs = performance.now() - this.heardMs;
    if (this.socket.readyState === WebSocket.OPEN && quietMs > QUIET_MS && this.state !== "unusable") {
      this.#say("quiet", `No frame for ${Math.floor(quietMs / 1000)} s: does mocapd still track?`);
    }
  }

  #say(name, text) {
    if (text === this.text) return;
    this.state = name;
    this.text = text;
    this.told.onState({ name, text });
  }
}
