// Copies what the page needs of its npm packages into vendor/, so that whoever opens it needs no npm:
//   npm ci --ignore-scripts && npm run vendor
// The versions are those of package-lock.json, by hash; vendor/SHA256SUMS says what was copied.

import { createHash } from "node:crypto";
import { mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";

const FROM = "node_modules/three";
const TO = "vendor/three";
const FILES = {
  "three.module.min.js": "build/three.module.min.js",
  "three.core.min.js": "build/three.core.min.js",
  "OrbitControls.js": "examples/jsm/controls/OrbitControls.js",
  LICENSE: "LICENSE",
};

rmSync("vendor", { recursive: true, force: true });
mkdirSync(TO, { recursive: true });
const sums = [];
for (const [name, source] of Object.entries(FILES)) {
  let text = readFileSync(`${FROM}/${source}`, "utf8");
  // a bare name would need an import map, which the page's content security policy forbids
  text = text.replace("from 'three';", "from './three.module.min.js';");
  writeFileSync(`${TO}/${name}`, text);
  sums.push(`${createHash("sha256").update(text).digest("hex")}  three/${name}`);
}
const { version } = JSON.parse(readFileSync(`${FROM}/package.json`, "utf8"));
writeFileSync("vendor/SHA256SUMS", `${sums.join("\n")}\n`);
console.log(`vendor/ holds three ${version}`);
