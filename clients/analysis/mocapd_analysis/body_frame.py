"""The person's own directions, so that reach and symmetry do not depend on where it stands and looks. Pure."""

import numpy as np

from mocapd.types import Floats
from mocapd_analysis.joint_angles import trunk_up
from mocapd_analysis.session import Session


def in_body_m(session: Session, names: tuple[str, ...]) -> Floats:
    """Joints as the person sees them (F,N,3) [m]: to its left, up, forward of the shoulders' middle.

    Up is the world's; forward is level, square to the line of the shoulders. Raises KeyError where shoulders
    or upper legs are unknown.
    """
    left, right = (session.positions_m(f"{side}UpperArm") for side in ("left", "right"))
    across = left - right
    # lying down the shoulders' line may be upright: then the trunk tells what is forward
    across = across - across * np.array([0.0, 1.0, 0.0])
    length = np.linalg.norm(across, axis=1, keepdims=True)
    lying = np.cross(trunk_up(session), [0.0, 1.0, 0.0])
    across = np.where(length > 0.05, across, lying)
    across = across / np.maximum(np.linalg.norm(across, axis=1, keepdims=True), 1e-9)
    up = np.broadcast_to([0.0, 1.0, 0.0], across.shape)
    axes = np.stack([across, up, np.cross(across, up)], axis=1)  # rows: left, up, forward
    places = np.stack([session.positions_m(name) for name in names], axis=1)
    apart = places - 0.5 * (left + right)[:, None]
    turned: Floats = np.einsum("fad,fnd->fna", axes, apart)
    return turned
