"""Make the golden VMC packets anew: `python -m tests.golden.make_vmc`.

For each way of bundling the datagrams of the pose in `stepping_left`, one file each, as they go over
the wire, and beside them `vmc_joints.json`: what a receiver must make of them.
"""

import json
from pathlib import Path
from typing import get_args

from mocapd.outputs.vmc.vmc_encoder import VmcEncoder
from mocapd.outputs.vmc.vmc_packets import Bundling
from mocapd.outputs.vmc.vmc_space import vmc_heading
from tests.golden import stepping_left

FOLDER = Path(__file__).parent / "vmc"
JOINTS = FOLDER / "vmc_joints.json"
CALIBRATION, TIME_S = 3, 12.5


def packets(bundling: Bundling) -> list[bytes]:
    """The datagrams of the pose."""
    encoder = VmcEncoder(vmc_heading(0.0, 0.0, by_root=False), False, bundling, None)
    datagrams = encoder.encode(
        stepping_left.frame(), stepping_left.rest(), calibration=CALIBRATION, time_s=TIME_S
    )
    return [bytes(one) for one in datagrams]


def kept(bundling: Bundling) -> list[bytes]:
    """The same from their files."""
    return [path.read_bytes() for path in sorted(FOLDER.glob(f"{bundling}_*.osc"))]


def joints_json() -> str:
    """Of each joint, by VRM 1.0 name: position in mocapd's world [m], and rotation relative to the bone above, x y z w."""
    joints = stepping_left.frame().joints
    told = {name: {"p_m": one.p, "local_xyzw": one.l} for name, one in joints.items()}
    rounded = {
        name: {key: [round(value, 6) for value in values] for key, values in one.items()}
        for name, one in told.items()
    }
    lines = ",\n".join(f"  {json.dumps(name)}: {json.dumps(one)}" for name, one in rounded.items())
    return f"{{\n{lines}\n}}\n"


def main() -> None:
    """Write the files."""
    FOLDER.mkdir(exist_ok=True)
    for bundling in get_args(Bundling):
        for number, datagram in enumerate(packets(bundling)):
            (FOLDER / f"{bundling}_{number:02}.osc").write_bytes(datagram)
    JOINTS.write_text(joints_json())


if __name__ == "__main__":
    main()
