"""A scene as pictures and the order they are shown in, over and over."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from mocapd.sim.film import Film
from mocapd.sim.setup_scenes import WEARER_S, SetupScene


@dataclass(frozen=True, slots=True, eq=False)
class Clip:
    """pictures[camera]: JPEG files; order: which of them each frame of the loop shows."""

    order: Sequence[int]
    pictures: Mapping[str, Sequence[bytes]]

    def jpeg(self, camera: str, frame: int) -> bytes:
        """What a camera sees `frame` frames after the scene began."""
        return self.pictures[camera][self.order[frame % len(self.order)]]


def wearer_clips(film: Film) -> dict[SetupScene, Clip]:
    """The wearer's scenes, cut from the scenario's film; each is played to its end and back."""
    clips = {}
    for scene, (from_s, to_s) in WEARER_S.items():
        start, end = (round(t * film.scenario.fps_hz) - film.first for t in (from_s, to_s))
        pictures = {camera: jpegs[start:end] for camera, jpegs in film.frames.items()}
        forth = range(end - start)
        clips[scene] = Clip([*forth, *forth[-2:0:-1]], pictures)
    return clips
