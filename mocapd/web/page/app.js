// The page: which of its two views is shown, and whether the daemon is there.

import { connect } from "./link.js";
import "./pictures.js";
import { finishedPage } from "./finished.js";
import { Live } from "./live.js";
import { Setup } from "./setup.js";

const CONNECTION = {
  connecting: ["Connecting", "working"],
  open: ["Connected", "done"],
  lost: ["Not connected, trying again", "failed"],
  refused: ["Ended", "failed"],
};
const NOTICES = {
  lost: "No connection to mocapd. It is sought again by itself; what was done so far is kept there.",
  refused:
    "mocapd was started anew. Open the new address that it printed; this page belongs to the start before.",
};

class Page {
  constructor() {
    this.views = { setup: document.getElementById("setup"), live: document.getElementById("live") };
    window.addEventListener("hashchange", () => this.route());
    document.querySelector(".skip").addEventListener("click", (event) => {
      event.preventDefault(); // or the address would name no view
      document.getElementById("main").focus();
    });
    this.route();
    this.link = connect();
    this.link.onState((state) => this.connection(state));
    this.link.onIdle((message) => this.idle(message));
    this.link.onView((view) => this.seated(view));
  }

  route() {
    const name = location.hash.slice(1);
    if (!Object.hasOwn(this.views, name)) return;
    for (const [other, root] of Object.entries(this.views)) {
      root.hidden = other !== name;
      const tab = document.getElementById(`to-${other}`);
      if (other === name) tab.setAttribute("aria-current", "page");
      else tab.removeAttribute("aria-current");
    }
    document.title = name === "live" ? "mocapd: live view" : "mocapd: setup";
    if (name === "live") this.live ??= new Live(this.views.live);
    else if (this.live) {
      this.live.destroy();
      this.live = null;
    }
  }

  connection(state) {
    if (this.finished) return; // whether somebody still serves it does not matter any more
    const [text, look] = CONNECTION[state];
    const shown = document.getElementById("connection");
    shown.textContent = text;
    shown.className = `state ${look}`;
    if (state !== "connecting") this.notice(NOTICES[state] ?? "");
  }

  notice(text, ...buttons) {
    const place = document.getElementById("notice");
    place.hidden = !text;
    if (place.dataset.text === text) return;
    place.dataset.text = text;
    place.replaceChildren(text, ...buttons);
  }

  /** Without a view in the address: the setup while one is going on, else the live view. */
  choose(name) {
    if (Object.hasOwn(this.views, location.hash.slice(1))) return;
    history.replaceState(null, "", `#${name}`);
    this.route();
  }

  /** A setup is going on: its frame is made once, and follows the link by itself. */
  seated(view) {
    if (view.saved && view.view.details.saved) {
      this.finish(view);
      return;
    }
    this.choose("setup");
    if (!this.setup) {
      delete this.views.setup.dataset.idle;
      const root = document.createElement("div");
      this.views.setup.replaceChildren(root);
      this.setup = new Setup(root, this.link);
    }
    if (view.driver) this.notice("");
    else {
      const take = action("take-over", "Take over", () => this.link.send("take_over"));
      this.notice("Another window leads this setup; this one looks on. ", take);
    }
  }

  /** Everything is saved: the last page, which stays. */
  finish(view) {
    if (this.finished) return;
    const details = view.view.details;
    this.notice("");
    this.setup?.destroy();
    this.setup = null;
    this.views.setup.replaceChildren(finishedPage(details, view.cameras));
    if (details.next_command) {
      this.finished = true; // this process ends: nothing is left to press or to wait for
      this.link.close();
      document.querySelector(".top nav").hidden = true;
      const shown = document.getElementById("connection");
      shown.textContent = "Saved";
      shown.className = "state done";
      history.replaceState(null, "", "#setup");
      this.route();
    }
    document.getElementById("finished").focus({ preventScroll: true });
  }

  /** No setup is going on. */
  idle(message) {
    if (document.getElementById("finished") && !message.refused) return;
    this.choose("live");
    this.notice("");
    this.setup?.destroy();
    this.setup = null;
    const root = this.views.setup;
    const said = message.refused;
    const text = said ? `${said.what}. ${said.fix}` : "";
    if (root.dataset.idle === "yes" && root.dataset.said === text) return;
    root.dataset.idle = "yes";
    root.dataset.said = text;
    const heading = document.createElement("h1");
    heading.textContent = "No setup is going on";
    const what = document.createElement("p");
    what.className = "sentence";
    what.textContent =
      "A setup leads through cameras, lenses, room, colours and body in about three minutes.";
    const refused = document.createElement("p");
    refused.className = "problem bad";
    refused.setAttribute("role", "alert");
    refused.hidden = !said;
    refused.textContent = text;
    const begin = action("begin", "Begin a setup", () => this.link.send("begin"), "primary");
    root.replaceChildren(heading, what, refused, begin);
  }
}

function action(name, text, onClick, look = "") {
  const made = document.createElement("button");
  made.type = "button";
  made.id = name;
  made.dataset.action = name;
  made.className = look;
  made.textContent = text;
  made.addEventListener("click", onClick);
  return made;
}

// The cookie lets us in from now on; a token in the address bar ends up in screenshots.
if (location.search) history.replaceState(null, "", location.pathname + location.hash);
new Page();
