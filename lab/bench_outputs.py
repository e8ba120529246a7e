"""What a frame costs each output, without the network: from the skeleton frame to the bytes.

`python -m lab.bench_outputs [--frames N] [--vrm FILE]`
"""

import argparse
import sys
import time
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np

from mocapd.body.skeleton import global_from_local, joint_positions, standard_skeleton
from mocapd.clock import NS_PER_S
from mocapd.evaluate.tables import number, table
from mocapd.geometry import rotations
from mocapd.outputs.from_body import skeleton_frame
from mocapd.outputs.from_skeleton import rest_skeleton
from mocapd.outputs.messages import RestSkeleton
from mocapd.outputs.osc.osc_frame import FrameBundles
from mocapd.outputs.vmc.avatar import Avatar
from mocapd.outputs.vmc.vmc_encoder import VmcEncoder
from mocapd.outputs.vmc.vmc_packets import Bundling
from mocapd.outputs.vmc.vmc_space import vmc_heading
from mocapd.outputs.vmc.vrm_file import read_vrm
from mocapd.outputs.wire import SkeletonFrame, encode_msgpack
from mocapd.types import BodyState, Pose, Tracking

STATURE_M = 1.75
RATE_HZ = 60.0
_WARM_UP = 20  # calls that are not timed
_SWING_RAD = 0.6
_NS_PER_MS = 1e6

Encode = Callable[[SkeletonFrame], object]


def moving_frames(count: int) -> list[SkeletonFrame]:
    """A person all of whose joints swing, each at its own pace."""
    skeleton = standard_skeleton(STATURE_M)
    joints = np.arange(len(skeleton.names))[:, None]
    frames = []
    for seq in range(count):
        turns_rad = _SWING_RAD * np.sin(seq / RATE_HZ * (1.0 + 0.1 * joints) + np.arange(3))
        pose = Pose(skeleton.rest_m[0], global_from_local(skeleton, rotations.exp(turns_rad)))
        t_ns = round(seq / RATE_HZ * NS_PER_S)
        joints_m = joint_positions(skeleton, pose)
        sure = np.ones(len(skeleton.names))
        body = BodyState(
            t_ns,
            Tracking.LIVE,
            "canned",
            pose,
            joints_m,
            sure,
            ("left", "right"),
            uncertainty_m=0.01 * sure,
        )
        frames.append(
            skeleton_frame(
                body,
                skeleton,
                instance="bench",
                seq=seq,
                publish_monotonic_ns=t_ns,
                unix_from_monotonic_ns=0,
            )
        )
    return frames


def encoders(avatar: Avatar | None) -> Mapping[str, Encode]:
    """By name; `avatar` adds VMC with its bones."""
    rest = rest_skeleton(standard_skeleton(STATURE_M), instance="bench", stature_m=STATURE_M)
    (first,) = moving_frames(1)
    found: dict[str, Encode] = {
        "zenoh, msgpack": encode_msgpack,
        "osc": FrameBundles(first).fill,
        "vmc, two bundles": _vmc("two", rest, None),
        "vmc, one bundle": _vmc("one", rest, None),
        "vmc, no bundles": _vmc("off", rest, None),
    }
    if avatar is not None:
        found["vmc, two bundles, avatar"] = _vmc("two", rest, avatar)
    return found


def _vmc(bundling: Bundling, rest: RestSkeleton, avatar: Avatar | None) -> Encode:
    encoder = VmcEncoder(vmc_heading(180.0, 5.0, by_root=False), False, bundling, avatar)
    return lambda frame: encoder.encode(frame, rest, calibration=3, time_s=1.0)


def timed_ms(encode: Encode, frames: list[SkeletonFrame]) -> tuple[float, float]:
    """Median and 95th percentile [ms]."""
    for frame in frames[:_WARM_UP]:
        encode(frame)
    took_ns = []
    for frame in frames:
        start_ns = time.perf_counter_ns()
        encode(frame)
        took_ns.append(time.perf_counter_ns() - start_ns)
    median_ns, p95_ns = np.percentile(took_ns, (50.0, 95.0)).tolist()
    return median_ns / _NS_PER_MS, p95_ns / _NS_PER_MS


def main() -> None:
    """The command in the module's docstring."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--frames", type=int, default=3000, help="how many [default: 3000]")
    parser.add_argument("--vrm", type=Path, help="an avatar's file, for VMC with its bones")
    told = parser.parse_args()
    frames = moving_frames(max(1, told.frames))
    rows = []
    for name, encode in encoders(read_vrm(told.vrm) if told.vrm else None).items():
        median_ms, p95_ms = timed_ms(encode, frames)
        rows.append((name, number(median_ms, 3), number(p95_ms, 3)))
    sys.stdout.write(table(("output", "median ms", "p95 ms"), rows) + "\n")


if __name__ == "__main__":
    main()
