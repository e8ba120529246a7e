// The page's connections to the daemon. All of them come back by themselves.
//
// connect() -> link
//   link.onView(fn)    fn(view) now and with each change of a setup; returns what stops it
//   link.onIdle(fn)    fn(message) now and whenever no setup is going on; returns what stops it
//   link.onState(fn)   fn("connecting" | "open" | "lost" | "refused"); returns what stops it
//   link.send(verb, args)
//   link.pictureUrl(key)
// view: {serial, step, steps, done, view: {state, sentence, progress, problems, details}, refused,
//        saved, ended, driver, cameras: [names]}

const PLACE = new URL("../", import.meta.url); // of the page; its path is another with each start
const FIRST_PAUSE_MS = 300;
const LONGEST_PAUSE_MS = 3000;
const ANSWER_MS = 10000; // without an answer for so long the browser would wait for minutes, or for ever

/** A WebSocket that is opened again whenever it closes. */
export class Socket {
  /** onMessage(event); onState(state) as of link.onState. */
  constructor(name, onMessage, onState = () => {}) {
    this.url = new URL(name, PLACE);
    this.url.protocol = "ws:";
    this.onMessage = onMessage;
    this.onState = onState;
    this.pause = FIRST_PAUSE_MS;
    this.closed = false;
    this.open();
  }

  open() {
    this.onState("connecting");
    const socket = new WebSocket(this.url);
    this.socket = socket;
    socket.binaryType = "arraybuffer";
    const unanswered = setTimeout(() => socket.close(), ANSWER_MS);
    socket.addEventListener("open", () => {
      clearTimeout(unanswered);
      this.pause = FIRST_PAUSE_MS;
      this.onState("open");
    });
    socket.addEventListener("message", this.onMessage);
    socket.addEventListener("close", () => {
      clearTimeout(unanswered);
      this.again();
    });
  }

  async again() {
    if (this.closed) return;
    this.onState((await isRefused()) ? "refused" : "lost");
    setTimeout(() => {
      if (!this.closed) this.open();
    }, this.pause);
    this.pause = Math.min(LONGEST_PAUSE_MS, this.pause * 1.6);
  }

  /** Whether it was sent: nothing is while there is no connection. */
  send(message) {
    if (this.socket.readyState !== WebSocket.OPEN) return false;
    this.socket.send(JSON.stringify(message));
    return true;
  }

  close() {
    this.closed = true;
    this.socket.close();
  }
}

/** A refused WebSocket tells nothing; a refused page does: the daemon was started anew. */
async function isRefused() {
  try {
    const answer = await fetch(new URL("status", PLACE), {
      signal: AbortSignal.timeout(ANSWER_MS),
    });
    return answer.status === 401 || answer.status === 403;
  } catch {
    return false;
  }
}

class Link {
  constructor() {
    this.views = new Listeners();
    this.idles = new Listeners();
    this.states = new Listeners();
    this.socket = new Socket(
      "ws",
      (event) => this.take(JSON.parse(event.data)),
      (state) => this.states.tell(state),
    );
  }

  take(message) {
    if (message.setup) {
      this.idles.forget();
      this.views.tell(message);
    } else {
      this.views.forget();
      this.idles.tell(message);
    }
  }

  onView(listener) {
    return this.views.add(listener);
  }

  onIdle(listener) {
    return this.idles.add(listener);
  }

  onState(listener) {
    return this.states.add(listener);
  }

  send(verb, args = {}) {
    return this.socket.send({ verb, args });
  }

  close() {
    this.socket.close();
  }

  pictureUrl(key) {
    const path = key.split("/").map(encodeURIComponent).join("/");
    return new URL(`picture/${path}`, PLACE).href;
  }
}

/** Functions that are told something, and what was told last to those who come later. */
class Listeners {
  constructor() {
    this.all = new Set();
    this.last = undefined;
  }

  add(listener) {
    this.all.add(listener);
    if (this.last !== undefined) listener(this.last);
    return () => this.all.delete(listener);
  }

  tell(what) {
    this.last = what;
    for (const listener of [...this.all]) listener(what);
  }

  forget() {
    this.last = undefined;
  }
}

/** The link of this window to the setup. */
export function connect() {
  return new Link();
}
