// The last page of a setup: what is saved where, and what to run next. It needs no connection.

import { button, element } from "./setup.js";

export function finishedPage(details, cameras) {
  const worn = details.has_shirt ? "the shirt's colours in this light" : "tracking in any clothes";
  const heading = element("h1", { id: "finished", tabindex: "-1" }, "The setup is saved");
  const parts = [
    heading,
    element("p", { class: "sentence" }, `Lenses and places of ${named(cameras)}, your body, and ${worn}.`),
    element("p", {}, "Saved in ", element("code", { id: "saved-to" }, details.saved)),
    element("h2", {}, "What comes next"),
  ];
  if (details.next_command) parts.push(commandRow(details.next_command));
  else parts.push(element("p", {}, "The running mocapd goes on with it: ", element("a", { href: "#live" }, "live view"), "."));
  parts.push(
    element("p", {}, "Then ", element("code", {}, "mocapd status"), " says how it fares, and ",
      element("code", {}, "mocapd watch"), " shows what games get."),
    element("p", { class: "soft" }, "When a camera was moved or the light has changed: ",
      element("code", {}, "mocapd calibrate --step room"), " or ", element("code", {}, "--step colour"), "."),
  );
  if (details.next_command) parts.push(element("p", { class: "soft" }, "You may close this page."));
  return element("div", { class: "finished" }, ...parts);
}

function commandRow(command) {
  const copied = element("span", { role: "status", class: "good" });
  const copy = button("copy", "Copy", async () => {
    try {
      await navigator.clipboard.writeText(command);
      copied.textContent = "Copied";
    } catch {
      getSelection().selectAllChildren(code); // where the browser refuses: Ctrl+C does it
      copied.textContent = "Selected: press Ctrl+C";
    }
  });
  const code = element("code", { id: "next-command" }, command);
  return element("p", { class: "row" }, "In a terminal: ", code, copy, copied);
}

function named(cameras) {
  return cameras.length === 1 ? "one camera" : `${cameras.length} cameras`;
}
