"""Where rays meet under each reading of their labels, and which of them agree."""

import numpy as np
from numpy.typing import NDArray

from mocapd.kernels.decorator import kernel

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


@kernel
def read_as(
    labels: Ints,
    squares: tuple[Array, Array, Array],
    joints_m: Array,
    least: float,
    robust2: float,
    reweights: int,
    costs: Array,
    shares: Array,
) -> None:
    """Under each reading, in which a camera's keypoint of labels (M,C,J) is joint j: what each joint costs (M,J), and what
    share of a keypoint's information agrees with the other cameras (M,C,J).

    squares: A (C,J,3,3), b (C,J,3), c (C,J), see `JointRays.squares`; joints_m (J,3): predicted, held with `least` [1/m^2];
    robust2: squared standard deviations at which a ray has a quarter of its weight.
    """
    A, b, c = squares
    S, s, x = np.empty((3, 3)), np.empty(3), np.empty(3)
    for m in range(labels.shape[0]):
        for j in range(labels.shape[2]):
            shares[m, :, j] = 1.0
            for _ in range(1 + reweights):
                S[:] = 0.0
                for i in range(3):
                    S[i, i] = least
                    s[i] = least * joints_m[j, i]
                for k in range(labels.shape[1]):
                    label, share = labels[m, k, j], shares[m, k, j]
                    for i in range(3):
                        s[i] += share * b[k, label, i]
                        for n in range(3):
                            S[i, n] += share * A[k, label, i, n]
                _solve_3(S, s, x)
                costs[m, j] = 0.0
                for k in range(labels.shape[1]):
                    label = labels[m, k, j]
                    off2 = c[k, label]
                    for i in range(3):
                        off2 -= 2.0 * b[k, label, i] * x[i]
                        for n in range(3):
                            off2 += x[i] * A[k, label, i, n] * x[n]
                    trust = 1.0 / (1.0 + off2 / robust2)
                    shares[m, k, j] = trust * trust
                    costs[m, j] += off2 * trust
            away2 = 0.0
            for i in range(3):
                away2 += least * (x[i] - joints_m[j, i]) ** 2
            costs[m, j] += away2 / (1.0 + away2 / robust2)


@kernel
def _solve_3(S: Array, s: Array, x: Array) -> None:
    """x (3,) of S x = s, by Cramer's rule."""
    minors = np.empty((3, 3))
    for i in range(3):
        for j in range(3):
            minors[i, j] = (
                S[(i + 1) % 3, (j + 1) % 3] * S[(i + 2) % 3, (j + 2) % 3]
                - S[(i + 1) % 3, (j + 2) % 3] * S[(i + 2) % 3, (j + 1) % 3]
            )
    det = S[0, 0] * minors[0, 0] + S[0, 1] * minors[0, 1] + S[0, 2] * minors[0, 2]
    for i in range(3):
        x[i] = (minors[0, i] * s[0] + minors[1, i] * s[1] + minors[2, i] * s[2]) / det
