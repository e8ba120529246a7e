// The page: one connection, one figure, and in words how it fares.

import { addressIn, forgetAddress, keepAddress, takeAddress } from "./address.js";
import { Figure } from "./figure.js";
import { Frames } from "./frames.js";
import { Stage } from "./stage.js";

const FIGURES_EVERY_MS = 250;
const LINK_WANTED = "Start mocapd with this site in web.allow_origins, and paste what `mocapd web-link` prints.";

const shown = (id) => document.getElementById(id);
export const figure = new Figure();
export const stage = makeStage();
let frames = null;
let newest = null; // frame
let drawn = null; // the one that the figure shows
let framesSince = 0;
let figuresMs = performance.now();
let drawnMs = performance.now();

function makeStage() {
  try {
    // for pictures of the page: ?full draws everything, however slowly
    const made = new Stage(shown("view"), new URLSearchParams(location.search).has("full"));
    made.scene.add(figure.group);
    return made;
  } catch (error) {
    console.warn(error);
    return null; // the figures are shown all the same
  }
}

function connect(address) {
  frames?.close();
  shown("ignored").hidden = true;
  frames = new Frames(address, {
    onRest: (rest) => {
      figure.build(rest);
      drawn = null;
    },
    onFrame: (frame) => {
      newest = frame;
      framesSince += 1;
    },
    onState: ({ name, text }) => {
      say(name, text);
      if (!["live", "nobody", "slow"].includes(name)) newest = null;
    },
    onIgnored: (count, why) => {
      shown("ignored").hidden = false;
      shown("ignored").textContent = `Ignored so far: ${count}. The last: ${why}.`;
    },
  });
}

function say(name, text) {
  shown("state").dataset.state = name;
  shown("state").textContent = stage === null ? `${text} This browser draws no WebGL.` : text;
}

// Once for each picture of the screen: the newest frame, however many have come.
function draw(nowMs) {
  requestAnimationFrame(draw);
  if (newest !== drawn) {
    if (newest === null) figure.hide(); // what stands still looks tracked
    else figure.show(newest.joints);
    drawn = newest;
    stage?.touch();
  }
  const hips = figure.positionOf("hips");
  if (hips !== null) stage?.follow(hips, (nowMs - drawnMs) / 1000);
  drawnMs = nowMs;
  stage?.draw(nowMs);
}

function showFigures() {
  const nowMs = performance.now();
  shown("rate").textContent = `${Math.round((framesSince * 1000) / (nowMs - figuresMs))} per second`;
  framesSince = 0;
  figuresMs = nowMs;
  shown("tracking").textContent = newest?.tracking ?? "–";
  shown("age").textContent = newest === null ? "–" : `${Math.round(Date.now() - newest.captureUnixMs)} ms`;
  shown("left-hand").textContent = inMetres(newest?.joints.get("leftHand"));
  shown("right-hand").textContent = inMetres(newest?.joints.get("rightHand"));
}

function inMetres(joint) {
  return joint === undefined ? "–" : `${joint.p.map((number) => number.toFixed(2)).join("  ")} m`;
}

// Connects to what `find` gives, or says why not.
function begin(find) {
  try {
    const address = find();
    if (address === null) say("none", LINK_WANTED);
    else connect(address);
  } catch (error) {
    say("unusable", error.message);
  }
}

shown("link-form").addEventListener("submit", (event) => {
  event.preventDefault();
  begin(() => {
    const address = addressIn(shown("link").value);
    keepAddress(address);
    shown("link").value = "";
    return address;
  });
});
shown("forget").addEventListener("click", () => {
  forgetAddress();
  frames?.close();
  newest = null;
  say("none", LINK_WANTED);
});
addEventListener("hashchange", () => begin(takeAddress));
begin(takeAddress);
setInterval(showFigures, FIGURES_EVERY_MS);
requestAnimationFrame(draw);
