"""The body: skeleton, shapes, surface with its areas, joint limits, inverse kinematics."""
