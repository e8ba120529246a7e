"""What webcams that are alike saw, kept for the next start, and the file of the simulated sockets."""

from random import Random

import cv2
import msgspec
import numpy as np

from mocapd.calibrate.bump.landmarks import find_landmarks
from mocapd.capture.simulated.sockets import Plugged, Sockets, SocketsFile
from mocapd.service import room_memory
from mocapd.service.room_memory import FILE_NAME, RoomMemory, read_rooms
from tests.fuzz.mutations import damaged
from tests.fuzz.row import Attempt, Place, WrongError
from tests.geometry.rigs import ring


def rooms(place: Place) -> Attempt:
    """A damaged memory is refused; where its checksum was made to fit, no mark lies outside of what a picture can be."""
    cameras = {camera.name: camera for camera in ring(2)}
    noise = np.random.default_rng(1).integers(0, 255, (480, 640, 3), dtype=np.uint8)
    pixels = np.asarray(cv2.GaussianBlur(noise, (0, 0), 6.0), np.uint8)
    memory, path = RoomMemory(place.folder), place.folder / FILE_NAME
    views = {name: [find_landmarks(pixels, camera)] for name, camera in cameras.items()}
    memory.write(cameras, views)
    data = path.read_bytes()
    body = data[room_memory.DIGEST_BYTES :]
    if len(memory.read(cameras)) != len(cameras):
        raise WrongError("what was written is not read")

    def attempt(random: Random, number: int) -> bool:
        if number % 4 == 0:
            path.write_bytes(damaged(random, data))
        else:
            # of most of it a byte more or less is a pixel
            head = 256 if number % 2 else len(body)
            changed = damaged(random, body[:head]) + body[head:]
            path.write_bytes(room_memory.digest_of(changed) + changed)
        found = read_rooms(path, cameras)
        for views in found.values():
            for view in views:
                if view.picture.ndim != 2 or not np.isfinite(view.rays).all():
                    raise WrongError("marks that no picture has")
        return bool(found)

    return attempt


def sockets(place: Place) -> Attempt:
    """Found as something that is plugged in, or a named error."""
    webcams = {"cam0": "usb:1-1:046d:0825:A0", "cam1": "usb:1-2:046d:0825:"}
    plugged = {"1-1": Plugged("cam0", 3), "1-4": Plugged("cam1")}
    data = msgspec.json.encode(SocketsFile(webcams, plugged))
    path = place.folder / "sockets.json"
    path.write_bytes(data)
    if Sockets(path).find("cam1").port != "1-4":
        raise WrongError("a webcam in another port is not found")

    def attempt(random: Random, number: int) -> bool:
        path.write_bytes(damaged(random, data))
        found = Sockets(path).find("cam0")
        return found.port in Sockets(path).now().sockets

    return attempt
