"""3D head tracking: a particle filter over the pictures of all cameras."""
