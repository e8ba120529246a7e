// The body as capsules between its joints. three.js has the daemon's axes: right-handed, +Y up, metres; a person at rest
// faces +Z with the left hand towards +X. So nothing is converted.

import * as THREE from "./vendor/three/three.module.min.js";

const RADII_M = [
  [/^(hips|spine|chest|upperChest)$/, 0.105],
  [/neck|head/, 0.05],
  [/Shoulder$/, 0.065],
  [/UpperArm$/, 0.05],
  [/LowerArm$/, 0.042],
  [/Hand$/, 0.034],
  [/UpperLeg$/, 0.085],
  [/LowerLeg$/, 0.068],
  [/Foot$/, 0.05],
  [/Toes$/, 0.042],
];
const COLOURS = { left: 0x4fc3f7, right: 0xffa04d, middle: 0xd5dde6 };
const UNSEEN = new THREE.Color(0x3a4350); // what no camera sees
const UP = new THREE.Vector3(0, 1, 0);
// what ends a limb, in its bone's own axes, which are the world's in the T-pose: middle and size [m]
const ENDS = {
  head: [[0, 0.11, 0.02], [0.085, 0.12, 0.1]],
  leftHand: [[0.085, 0, 0], [0.09, 0.022, 0.045]],
  rightHand: [[-0.085, 0, 0], [0.09, 0.022, 0.045]],
  leftToes: [[0, 0, 0.03], [0.045, 0.03, 0.06]],
  rightToes: [[0, 0, 0.03], [0.045, 0.03, 0.06]],
};
const NOSE = [[0, 0.1, 0.12], [0.02, 0.025, 0.03]]; // shows which way the person faces

export class Figure {
  constructor() {
    this.group = new THREE.Group();
    this.group.visible = false;
    this.parts = new Map(); // by bone: material, ball, limb from the parent, ends
  }

  // The bones that there are. Call it before the first frame, and again when it changes.
  build({ names, parents }) {
    for (const { geometry, material } of this.group.children) {
      geometry.dispose(); // what is drawn by a graphics card is not collected
      material.dispose();
    }
    this.group.clear();
    this.parts.clear();
    names.forEach((name, i) => {
      const side = name.startsWith("left") ? "left" : name.startsWith("right") ? "right" : "middle";
      const colour = new THREE.Color(COLOURS[side]);
      const material = new THREE.MeshStandardMaterial({ color: colour, roughness: 0.55 });
      const radius = RADII_M.find(([pattern]) => pattern.test(name))?.[1] ?? 0.03;
      const ball = this.#mesh(new THREE.SphereGeometry(radius, 20, 14), material);
      const limb = parents[i] < 0 ? null : this.#mesh(new THREE.CylinderGeometry(radius, radius, 1, 20), material);
      const ends = (name in ENDS ? [ENDS[name]] : []).concat(name === "head" ? [NOSE] : []).map(([middle, size]) => {
        const end = this.#mesh(new THREE.SphereGeometry(1, 20, 14), material);
        end.scale.set(...size);
        end.userData.middle = new THREE.Vector3(...middle);
        return end;
      });
      this.parts.set(name, { parent: names[parents[i]], colour, material, ball, limb, ends });
    });
  }

  // The joints of one frame; those that are missing, or that the tracker knows nothing of, are not drawn. Nobody there:
  // nothing is.
  show(joints) {
    this.group.visible = joints.size > 0;
    const turn = new THREE.Quaternion();
    for (const [name, part] of this.parts) {
      const joint = known(joints, name);
      const from = known(joints, part.parent);
      part.ball.visible = joint !== undefined;
      if (part.limb) part.limb.visible = joint !== undefined && from !== undefined;
      for (const end of part.ends) end.visible = joint !== undefined;
      if (joint === undefined) continue;
      part.material.color.lerpColors(UNSEEN, part.colour, Math.min(1, Math.max(0, joint.c * 2)));
      part.ball.position.fromArray(joint.p);
      turn.fromArray(joint.r).normalize();
      for (const end of part.ends) {
        end.quaternion.copy(turn);
        end.position.copy(end.userData.middle).applyQuaternion(turn).add(part.ball.position);
      }
      if (part.limb?.visible) place(part.limb, from.p, joint.p);
    }
  }

  hide() {
    this.group.visible = false;
  }

  // Where a joint is drawn [m], for whoever lets something collide with it; null when it is not.
  positionOf(name) {
    const ball = this.parts.get(name)?.ball;
    return this.group.visible && ball?.visible ? ball.position.clone() : null;
  }

  #mesh(geometry, material) {
    const mesh = new THREE.Mesh(geometry, material);
    mesh.castShadow = true;
    this.group.add(mesh);
    return mesh;
  }
}

function known(joints, name) {
  const joint = joints.get(name);
  return joint?.c > 0 ? joint : undefined;
}

// A cylinder of height 1 along its own +Y, from one point to the other.
function place(limb, from, to) {
  const start = new THREE.Vector3(...from);
  const along = new THREE.Vector3(...to).sub(start);
  const length = along.length();
  limb.visible = length > 1e-4;
  limb.position.copy(start).addScaledVector(along, 0.5);
  limb.scale.set(1, length, 1);
  limb.quaternion.setFromUnitVectors(UP, along.divideScalar(length || 1));
}
