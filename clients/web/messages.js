// What the daemon says, checked: docs/wire.md says what each field means. Nothing here throws.

export const SKELETON = "mocapd.Skeleton.v1";
export const REST = "mocapd.Skeleton.Rest.v1";
export const HEALTH = "mocapd.Health.v1";
const FAMILY = /^mocapd\.Skeleton(\.Rest)?\.v/;
const LARGEST = 1e6; // of any number of a joint
const LONGEST = 1 << 20; // characters of a message; a frame has 6,000

// One of {rest}, {frame}, {slowness: why tracking is too slow, or empty}, {ignored: why}, {version: the schema of another version}, {} for what is of no interest.
// frame: seq, tracking, captureUnixMs and joints, a Map of {p, r, l, c} by VRM 1.0 bone name; broken: how many joints
// were left out, as one of their numbers is none.
export function read(data) {
  if (typeof data !== "string" || data.length > LONGEST) return { ignored: "no text, or too long" };
  let tree;
  try {
    tree = JSON.parse(data);
  } catch {
    return { ignored: "no JSON" };
  }
  const schema = isObject(tree) ? tree.schema : undefined;
  if (schema === SKELETON) return readFrame(tree);
  if (schema === REST) return readRest(tree);
  if (schema === HEALTH) return { slowness: typeof tree.slowness === "string" ? tree.slowness.slice(0, 300) : "" };
  if (typeof schema !== "string") return { ignored: "no message of mocapd" };
  return FAMILY.test(schema) ? { version: schema.slice(0, 60) } : {}; // others may be added
}

function readFrame(tree) {
  const { seq, tracking, capture_unix_ns: captured } = tree;
  if (!Number.isFinite(seq) || typeof tracking !== "string" || !Number.isFinite(captured) || !isObject(tree.joints)) {
    return { ignored: "a frame without its fields" };
  }
  const joints = new Map();
  let broken = 0;
  for (const [name, joint] of Object.entries(tree.joints)) {
    if (isJoint(joint)) joints.set(name, joint);
    else broken += 1;
  }
  // nanoseconds of this century are beyond a double's integers: good to half a microsecond
  return { frame: { seq, tracking, captureUnixMs: captured / 1e6, joints, broken } };
}

function isJoint(joint) {
  return isObject(joint) && areNumbers(joint.p, 3) && areNumbers(joint.r, 4) && areNumbers(joint.l, 4)
    && isNumber(joint.c);
}

function readRest(tree) {
  const { names, parents, offsets_m: offsets } = tree;
  const fits = [names, parents, offsets].every(Array.isArray)
    && names.length === parents.length && names.length === offsets.length
    && names.every((name) => typeof name === "string")
    && parents.every((parent, place) => Number.isInteger(parent) && parent >= -1 && parent < place)
    && offsets.every((offset) => areNumbers(offset, 3));
  return fits ? { rest: { names, parents, offsets } } : { ignored: "a rest skeleton that does not fit together" };
}

function areNumbers(list, count) {
  return Array.isArray(list) && list.length === count && list.every(isNumber);
}

// As docs/wire.md bounds it: beyond, WebGL's floats would be infinite.
function isNumber(value) {
  return Number.isFinite(value) && Math.abs(value) <= LARGEST;
}

function isObject(value) {
  return typeof value === "object" && value !== null && !Array.isArray(value);
}
