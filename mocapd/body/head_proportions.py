"""Where the middle of a head is, and how wide its face, in shares of the stature."""

import numpy as np

# From the head's joint, for a person who faces +Z: half way from chin to crown and from face to nape.
MIDDLE = np.array([0.0, 0.050, 0.020])
FACE_WIDTH = 0.100  # side of the face detector's box, from brow to chin
