"""Numbers that several parts of the head's tracking share, with units and reasons."""

FACE_SD = 0.09  # of a face box's middle, share of its side
FACE_DEPTH_SD = 0.15  # of a distance by apparent size, share
# The distances of a head. At the farthest a face is 17 px wide for a webcam, less than the detector's window.
NEAREST_M, FARTHEST_M = 0.5, 5.5
LEAST_WINDOWS = 3  # of a face that is believed
MEETING_M = 0.08  # how near the rays of two views must pass to mean one face
LEARN_SUPPORT = 0.9  # least support for learning colours without a face
SIZE_SHARE = (0.65, 1.5)  # a face's true width against a grown person's


def is_head_sized(size_share: float) -> bool:
    """True for a face of a person's size; size_share: its true width against a grown person's."""
    return SIZE_SHARE[0] < size_share < SIZE_SHARE[1]
