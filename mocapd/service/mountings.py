"""Looks now and then whether a camera was bumped, or two have changed places, and says so once."""

import logging

from mocapd.calibrate.bump.bump_watch import BumpWatch, Mounting
from mocapd.calibrate.bump.changed_places import Places
from mocapd.calibrate.bump.places_watch import PlacesWatch
from mocapd.pipeline.frame_hub import FrameHub
from mocapd.types import Frame, Rig

_log = logging.getLogger(__name__)


class Mountings:
    """How the cameras of a rig are mounted, from the newest pictures of a hub. For one thread.

    A rig that was calibrated anew gets another one of these.
    """

    def __init__(self, rig: Rig | None, hub: FrameHub) -> None:
        """No rig: nothing can be told."""
        self._hub = hub
        self._cameras = [c for c in rig.cameras if c.name in hub.names] if rig else []
        self._watch = BumpWatch(self._cameras)
        self._places = PlacesWatch(self._cameras)
        self._looked_at: dict[str, Frame] = {}

    def of(self, camera: str) -> Mounting:
        """As last seen."""
        if self._places.is_swapped(camera):
            return Mounting.SWAPPED
        return self._watch.mounting(camera)

    def look(self) -> None:
        """Call it about once a second; a picture of each camera takes some milliseconds, a look at two of them a fifth of a
        second, in the first minute."""
        for camera in self._cameras:
            frame = self._hub.newest(camera.name)
            if frame is None or frame is self._looked_at.get(camera.name):
                continue
            if frame.pixels.shape[1::-1] != camera.size_px:
                continue  # the tracker says what is wrong
            self._looked_at[camera.name] = frame
            before = self._watch.mounting(camera.name)
            now = self._watch.look(camera.name, frame.t_ns, frame.pixels)
            if now is Mounting.BUMPED and before is not now:
                _log.warning(
                    "camera %r was turned by about %.1f degrees, its calibration no longer holds --"
                    " put it back, or run `mocapd calibrate --step room`",
                    *(camera.name, self._watch.turn_deg(camera.name)),
                )
            elif before is Mounting.BUMPED and now is Mounting.STEADY:
                _log.info("camera %r is back in its place", camera.name)
        self._look_at_places()

    def _look_at_places(self) -> None:
        found = self._places.look(self._looked_at)
        if found is None:
            return
        names, places = found
        if places is Places.CHANGED:
            _log.warning(
                "cameras %r and %r have changed places: each shows what the other's calibration is for --"
                " exchange them, or run `mocapd calibrate --step room`",
                *names,
            )
