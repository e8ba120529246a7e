// Where the frames are: in the link that `mocapd web-link` prints, after its #, which no browser sends to the site.

const FRAGMENT = "#mocapd=";
const STORED = "mocapd"; // in the localStorage of this site
const HERE = ["127.0.0.1", "localhost"]; // a link that leads elsewhere is nobody's daemon

// The address in a link, or in what follows its #, or given by itself; throws an Error that says what is wrong.
export function addressIn(link) {
  const at = link.indexOf(FRAGMENT);
  const text = (at < 0 ? link : link.slice(at + FRAGMENT.length)).trim();
  let url;
  try {
    url = new URL(text);
  } catch {
    throw new Error("That is no link: it has to be what `mocapd web-link` prints.");
  }
  if (url.protocol !== "ws:" || !HERE.includes(url.hostname)) {
    throw new Error("That link leads to no mocapd on this machine.");
  }
  url.hash = "";
  return url.href;
}

// What the page was opened with, taken out of the address bar and kept; else what was kept; null without either.
export function takeAddress() {
  if (location.hash.startsWith(FRAGMENT)) {
    const link = location.hash;
    history.replaceState(null, "", location.pathname + location.search);
    keepAddress(addressIn(link));
  }
  const kept = localStorage.getItem(STORED);
  return kept === null ? null : addressIn(kept);
}

export function keepAddress(address) {
  localStorage.setItem(STORED, address);
}

export function forgetAddress() {
  localStorage.removeItem(STORED);
}
