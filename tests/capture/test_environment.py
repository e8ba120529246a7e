"""A stalled webcam is noticed after one second only if OpenCV is told before it is imported."""

import subprocess
import sys

SAY = (
    "from mocapd.capture import environment as e; import os; "
    "print(e.CV2_CAME_FIRST, os.environ[e.STALL_TIMEOUT_VARIABLE])"
)


def said_by(code: str, env: dict[str, str]) -> str:
    command = [sys.executable, "-c", code]
    return subprocess.run(command, env=env, capture_output=True, text=True, check=True).stdout


def test_the_timeout_is_set_before_opencv_is_loaded(clean_env: dict[str, str]) -> None:
    env = {k: v for k, v in clean_env.items() if not k.startswith("OPENCV_")}
    assert said_by(f"import mocapd.capture.webcam.v4l2; {SAY}", env).split() == ["False", "1"]
    assert said_by(f"import cv2; {SAY}", env).split() == ["True", "1"]


def test_a_value_of_the_user_is_left_alone(clean_env: dict[str, str]) -> None:
    env = clean_env | {"OPENCV_VIDEOIO_V4L_SELECT_TIMEOUT": "7"}
    assert said_by(SAY, env).split() == ["False", "7"]


def test_capture_does_not_load_numba(clean_env: dict[str, str]) -> None:
    code = "import mocapd.capture.webcam.v4l2, mocapd.capture.camera_thread.thread, sys; print('numba' in sys.modules)"
    assert said_by(code, clean_env).strip() == "False"
