// What is said aloud in the setup, as one stands three metres from the screen: a chime, and the instruction by the
// browser's own voice. Switched by a button; the choice is kept in this browser.

const KEPT_AS = "mocapd-sound";
const QUIET_MS = 1200; // between two instructions
const NOTES_HZ = { done: [660, 880], next: [880], attention: [440] };
const LENGTH_S = 0.18;

export class Sound {
  constructor() {
    this.on = localStorage.getItem(KEPT_AS) !== "off";
    this.heard = {}; // of the step: state, sentence and count as they were
    this.saidMs = -Infinity;
  }

  switch() {
    this.on = !this.on;
    localStorage.setItem(KEPT_AS, this.on ? "on" : "off");
    if (this.on) this.chime("next");
    else window.speechSynthesis?.cancel();
  }

  /** A view of a step has come: says what has changed since the one before. */
  hear(step, view) {
    const now = { step, state: view.state, sentence: view.sentence.replace(/[\d:]+/g, "").trim(), count: count(view.details) };
    const before = this.heard;
    this.heard = now;
    if (!this.on || before.step === undefined) return; // what is there when the page opens is read, not heard
    const isDone = now.state === "done" && (before.state !== "done" || before.step !== step);
    if (isDone) this.tell("done", "Done.", true);
    else if (now.count > before.count && before.step === step) this.tell("next", "Next.");
    else if (now.state !== "done" && now.sentence && now.sentence !== before.sentence) {
      this.tell("attention", now.sentence, now.state === "failed");
    }
  }

  tell(chime, words, atOnce = false) {
    const nowMs = performance.now();
    if (!atOnce && nowMs - this.saidMs < QUIET_MS) return;
    this.saidMs = nowMs;
    this.chime(chime);
    if (!window.speechSynthesis) return;
    window.speechSynthesis.cancel(); // the newest instruction is the one that holds
    const spoken = new SpeechSynthesisUtterance(words);
    spoken.lang = "en";
    window.speechSynthesis.speak(spoken);
  }

  chime(name) {
    if (!window.AudioContext) return;
    this.audio ??= new AudioContext();
    if (this.audio.state === "suspended") this.audio.resume(); // browsers keep it so until a first click
    NOTES_HZ[name].forEach((hz, i) => {
      const at_s = this.audio.currentTime + i * LENGTH_S;
      const [tone, volume] = [this.audio.createOscillator(), this.audio.createGain()];
      tone.frequency.value = hz;
      volume.gain.setValueAtTime(0.2, at_s);
      volume.gain.exponentialRampToValueAtTime(0.001, at_s + LENGTH_S);
      tone.connect(volume).connect(this.audio.destination);
      tone.start(at_s);
      tone.stop(at_s + LENGTH_S);
    });
  }

  destroy() {
    window.speechSynthesis?.cancel();
    this.audio?.close();
  }
}

/** How many views or places of the board were taken. */
function count(details) {
  const views = Object.values(details.cameras ?? {}).map((camera) => camera.views ?? 0);
  return views.reduce((sum, one) => sum + one, details.moments ?? 0);
}
