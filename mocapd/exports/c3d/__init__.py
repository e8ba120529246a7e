"""C3D: biomechanics."""
