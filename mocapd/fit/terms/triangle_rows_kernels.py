"""The rows of the normal equations that pulls on the surface's triangles in a picture give."""

import numpy as np
from numpy.typing import NDArray

from mocapd.body.arrays import Articulation, PinholeArrays, PosedJoints, TriangleArrays
from mocapd.kernels.decorator import kernel

Array = NDArray[np.float64]

_BLOCK = 128  # rows that are multiplied at a time
_LEAST = 1e-9  # share of a triangle's weight below which a direction has none


@kernel(fastmath={"reassoc", "contract"})
def add_products(rows: Array, square: Array) -> None:
    """Add rows^T rows to square (P,P), which is symmetric, of rows (N,P).

    Without the columns that are 0 in all of them, which change no sum: pixels beside each other are of few limbs, and half
    of the columns take a third of the time. As fast as BLAS, for which numba imports scipy in a fifth of a second.
    """
    n, P = rows.shape
    used = np.zeros(P, np.bool_)
    for i in range(n):
        row = rows[i]
        for p in range(P):
            used[p] |= row[p] != 0.0
    columns = np.empty(P + 1, np.int64)
    m = 0
    for p in range(P):
        if used[p]:
            columns[m] = p
            m += 1
    if m == 0:
        return
    # columns as pairs of contiguous rows; the last one of an odd number is paired with zeros
    columns[m] = columns[m - 1]
    pairs = (m + 1) // 2
    packed = np.zeros((2 * pairs, n))
    for i in range(n):
        row = rows[i]
        for k in range(m):
            packed[k, i] = row[columns[k]]
    for k in range(pairs):
        x, y = packed[2 * k], packed[2 * k + 1]
        x_column, y_column = columns[2 * k], columns[2 * k + 1]
        for q in range(k + 1):
            u, v = packed[2 * q], packed[2 * q + 1]
            xu = xv = yu = yv = 0.0
            for i in range(n):
                xu += x[i] * u[i]
                xv += x[i] * v[i]
                yu += y[i] * u[i]
                yv += y[i] * v[i]
            square[x_column, columns[2 * q]] += xu
            square[y_column, columns[2 * q]] += yu
            square[y_column, columns[2 * q + 1]] += yv
            if q < k:
                square[x_column, columns[2 * q + 1]] += xv
    for k in range(m):
        for q in range(k):
            square[columns[q], columns[k]] = square[columns[k], columns[q]]


@kernel(fastmath=True)
def add_triangle_rows(
    pulls: Array,
    centres: Array,
    surface: TriangleArrays,
    articulation: Articulation,
    posed: PosedJoints,
    d_joints: Array,
    camera: PinholeArrays,
    H: Array,
    b: Array,
) -> None:
    """Add the pulls (T,5) on the triangles to H (P,P), b (P,), and set them to zero.

    A pull is the sum of rows w n n^T (xx, xy, yy) and w r n (x, y) in the picture, of which the bones feel a share, the
    triangle's stiffness. With the derivative J (2,P) of the centre's place there, H gets J^T (sum w n n^T) J, and b gets
    J^T (sum w r n). The sum is factored (Cholesky), so that each triangle gives at most two rows, however many pixels it
    has. centres (T,3) in the T-pose [m]. H has columns for the pose alone, or for pose and shape; then d_joints (N,J,3) are
    the derivatives of the posed joints by the shape factors.
    """
    _, triangle_bones, triangle_weights, stiffness, d_centres = surface
    parents, group_of_joint, share_of_joint, joint_of_group, d_rest = articulation
    rest, R, joints, _ = posed
    cam_R, cam_t, fx, fy = camera
    P, J = H.shape[0], parents.shape[0]
    n_shape = P - 3 - 3 * joint_of_group.shape[0]
    # of each joint: the sum of what the bones below it carry, and of their weights
    carried = np.zeros((J, 4))
    axes = np.empty((J, 3, 3))  # about which a joint's group turns, as columns
    for j in range(J):
        for i in range(3):
            for c in range(3):
                axes[j, i, c] = R[parents[j], i, c] if parents[j] >= 0 else (1.0 if i == c else 0.0)
    gradient = np.empty((2, 3))  # of the two rows by the centre's place in the world
    rows = np.empty((_BLOCK, P + 1))
    n_rows = 0
    square = np.zeros((P + 1, P + 1))
    for t in range(pulls.shape[0]):
        xx, yy = stiffness[t] * pulls[t, 0], stiffness[t] * pulls[t, 2]
        total = xx + yy
        if total == 0.0:
            continue
        xy, bx, by = (
            stiffness[t] * pulls[t, 1],
            stiffness[t] * pulls[t, 3],
            stiffness[t] * pulls[t, 4],
        )
        for i in range(5):
            pulls[t, i] = 0.0
        lx = ly = along = across = 0.0
        if xx > _LEAST * total:
            lx = np.sqrt(xx)
            ly, along = xy / lx, bx / lx
        left = yy - ly * ly
        l2 = 0.0
        if left > _LEAST * total:
            l2 = np.sqrt(left)
            across = (by - ly * along) / l2
        point = centres[t]
        X = Y = Z = 0.0
        for k in range(triangle_bones.shape[1]):
            wt = triangle_weights[t, k]
            if wt == 0.0:
                continue
            j = triangle_bones[t, k]
            qx, qy, qz = point[0] - rest[j, 0], point[1] - rest[j, 1], point[2] - rest[j, 2]
            px = wt * (R[j, 0, 0] * qx + R[j, 0, 1] * qy + R[j, 0, 2] * qz + joints[j, 0])
            py = wt * (R[j, 1, 0] * qx + R[j, 1, 1] * qy + R[j, 1, 2] * qz + joints[j, 1])
            pz = wt * (R[j, 2, 0] * qx + R[j, 2, 1] * qy + R[j, 2, 2] * qz + joints[j, 2])
            X += px
            Y += py
            Z += pz
            while j >= 0:
                carried[j, 0] += px
                carried[j, 1] += py
                carried[j, 2] += pz
                carried[j, 3] += wt
                j = parents[j]
        cx = cam_R[0, 0] * X + cam_R[0, 1] * Y + cam_R[0, 2] * Z + cam_t[0]
        cy = cam_R[1, 0] * X + cam_R[1, 1] * Y + cam_R[1, 2] * Z + cam_t[1]
        cz = cam_R[2, 0] * X + cam_R[2, 1] * Y + cam_R[2, 2] * Z + cam_t[2]
        first = n_rows
        for one in range(2):
            nx, ny = (lx, ly) if one == 0 else (0.0, l2)
            if nx == 0.0 and ny == 0.0:
                continue
            ux, uy = nx * fx / cz, ny * fy / cz
            uz = -(ux * cx + uy * cy) / cz
            g = gradient[n_rows - first]
            for i in range(3):
                g[i] = cam_R[0, i] * ux + cam_R[1, i] * uy + cam_R[2, i] * uz
                rows[n_rows, i] = g[i]
            for p in range(3, P):
                rows[n_rows, p] = 0.0
            rows[n_rows, P] = along if one == 0 else across
            n_rows += 1
        for j in range(J):
            wj = carried[j, 3]
            if wj == 0.0:
                continue
            group, f = group_of_joint[j], share_of_joint[j]
            if group >= 0:
                rx = f * (carried[j, 0] - wj * joints[j, 0])
                ry = f * (carried[j, 1] - wj * joints[j, 1])
                rz = f * (carried[j, 2] - wj * joints[j, 2])
                for n in range(first, n_rows):
                    g = gradient[n - first]
                    gx, gy, gz = g[0], g[1], g[2]
                    # a . (r x g) summed over the group's axes a
                    mx, my, mz = ry * gz - rz * gy, rz * gx - rx * gz, rx * gy - ry * gx
                    for i in range(3):
                        rows[n, 3 + 3 * group + i] += (
                            axes[j, 0, i] * mx + axes[j, 1, i] * my + axes[j, 2, i] * mz
                        )
            carried[j, 0] = carried[j, 1] = carried[j, 2] = carried[j, 3] = 0.0
        if n_shape > 0:
            for n in range(first, n_rows):
                g = gradient[n - first]
                gx, gy, gz = g[0], g[1], g[2]
                for k in range(triangle_bones.shape[1]):
                    wt, j = triangle_weights[t, k], triangle_bones[t, k]
                    # g in the bone's frame
                    hx = R[j, 0, 0] * gx + R[j, 1, 0] * gy + R[j, 2, 0] * gz
                    hy = R[j, 0, 1] * gx + R[j, 1, 1] * gy + R[j, 2, 1] * gz
                    hz = R[j, 0, 2] * gx + R[j, 1, 2] * gy + R[j, 2, 2] * gz
                    for s in range(n_shape):
                        rows[n, P - n_shape + s] += wt * (
                            hx * (d_centres[s, t, 0] - d_rest[s, j, 0])
                            + hy * (d_centres[s, t, 1] - d_rest[s, j, 1])
                            + hz * (d_centres[s, t, 2] - d_rest[s, j, 2])
                            + gx * d_joints[s, j, 0]
                            + gy * d_joints[s, j, 1]
                            + gz * d_joints[s, j, 2]
                        )
        if n_rows > _BLOCK - 2:
            add_products(rows[:n_rows], square)
            n_rows = 0
    add_products(rows[:n_rows], square)
    for p in range(P):
        b[p] += square[p, P]
        for q in range(P):
            H[p, q] += square[p, q]
