"""The Zenoh keys of mocapd: `mocapd/v1/<instance>/...`, one function per key."""

from mocapd.outputs.instance import chunk

ROOT = "mocapd/v1"
ANY = "*"  # in place of a name: every one of them


def skeleton(instance: str, person: int | str) -> str:
    """Frames of one person."""
    return f"{ROOT}/{instance}/skeleton/{person}"


def health(instance: str) -> str:
    """State: `messages.Health`."""
    return f"{ROOT}/{instance}/health"


def camera_status(instance: str, camera: str) -> str:
    """State: `messages.CameraStatus`; the camera's name as a chunk."""
    return f"{ROOT}/{instance}/camera/{camera if camera == ANY else chunk(camera)}/status"


def calibration(instance: str) -> str:
    """State: `messages.CalibrationInfo`."""
    return f"{ROOT}/{instance}/calibration"


def rest_skeleton(instance: str, person: int | str) -> str:
    """State: `messages.RestSkeleton`. Not below the frames' key: a subscriber of `skeleton/**` wants frames."""
    return f"{ROOT}/{instance}/rest_skeleton/{person}"


def facing(instance: str, person: int | str) -> str:
    """State: `messages.Facing`."""
    return f"{ROOT}/{instance}/facing/{person}"


def schema(instance: str, name: str) -> str:
    """The JSON schema of one message."""
    return f"{ROOT}/{instance}/schema/{name}"


def alive(instance: str) -> str:
    """The liveliness token, there while the daemon runs."""
    return f"{ROOT}/{instance}/alive"
