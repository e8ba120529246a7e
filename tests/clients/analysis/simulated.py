"""Sessions of mocapd's own simulated people, as the demo moves them: nobody's recording."""

import numpy as np

from mocapd.assets import asset_path
from mocapd.body.skeleton import joint_positions, standard_skeleton
from mocapd.sim.person.motion import compile_motion, pose_at
from mocapd.sim.scenario import load_scenario
from mocapd_analysis.session import Session
from mocapd_analysis.session_files import checked_session

RATE_HZ = 30.0


def simulated_session(scenario: str, seconds: float, stature_m: float = 1.75) -> Session:
    """One of calib/scenarios by its name, with two times in which nobody was tracked."""
    skeleton = standard_skeleton(stature_m)
    motion = compile_motion(load_scenario(asset_path(f"scenarios/{scenario}.toml")), skeleton)
    times_s = np.arange(0.0, seconds, 1.0 / RATE_HZ)
    joints_m = np.stack([joint_positions(skeleton, pose_at(motion, t)) for t in times_s])
    lost = (np.abs(times_s - 0.4 * seconds) < 0.3) | (np.abs(times_s - 0.8 * seconds) < 0.2)
    return checked_session(
        scenario,
        skeleton.names,
        times_s[~lost],
        joints_m[~lost],
        np.ones((int((~lost).sum()), len(skeleton.names))),
    )
