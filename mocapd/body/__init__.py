"""The body: skeleton, shapes, surface with the shirt's patches, joint limits, inverse kinematics."""
