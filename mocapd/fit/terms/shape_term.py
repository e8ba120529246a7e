"""What evidence of pose and shape together says of the shape alone."""

import numpy as np

from mocapd.fit.solve_kernels import FREE_POSE
from mocapd.types import Floats


def free_shape_information(H: Floats, held: Floats) -> Floats:
    """Information (n_shape,n_shape) on the shape factors when the pose is free: the Schur complement of H (P,P), with the
    pose first; held (n_pose,n_pose): information of the usual range of poses."""
    n = len(held)
    of_pose, of_both = H[:n, :n] + held + FREE_POSE * np.eye(n), H[:n, n:]
    return np.asarray(H[n:, n:] - of_both.T @ np.linalg.solve(of_pose, of_both))
