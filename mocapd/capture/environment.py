"""Settings that OpenCV reads from the environment while it is imported.

Import this module before anything that imports cv2: the command line and the daemon do so in
their first import, the modules of this package do so above their own `import cv2`. A value that
the user has set is left alone.
"""

import os
import sys

CV2_CAME_FIRST = "cv2" in sys.modules
"""True when cv2 was loaded before this module: then a stalled webcam blocks `read` for 10 s."""

STALL_TIMEOUT_VARIABLE = "OPENCV_VIDEOIO_V4L_SELECT_TIMEOUT"

# How long a read waits for a webcam that stays plugged and sends nothing [s]; OpenCV's own is 10.
os.environ.setdefault(STALL_TIMEOUT_VARIABLE, "1")
# The libraries' chatter about absent cameras and damaged videos; mocapd says it in its own words.
os.environ.setdefault("OPENCV_LOG_LEVEL", "ERROR")
os.environ.setdefault("OPENCV_FFMPEG_LOGLEVEL", "-8")
# What no picture file may exceed, whatever its header says [pixels]; OpenCV's own limit is 3 GB of them.
# PNG and JPEG are measured by `boundary.image_decoding`; this holds for the other kinds of the user's files.
os.environ.setdefault("OPENCV_IO_MAX_IMAGE_PIXELS", "40000000")
