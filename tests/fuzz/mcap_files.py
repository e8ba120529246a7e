"""Recordings that are damaged, cut short or say what cannot be: frames, pictures and what is known."""

from pathlib import Path
from random import Random

from mocapd.calibration.from_origin import from_origin
from mocapd.capture.recording.mcap_origin import open_recording
from mocapd.outputs.mcap.recording_reader import RecordingReader
from tests.capture.recorded_pictures import recorded_capture
from tests.fuzz.mutations import damaged
from tests.fuzz.row import Attempt, Place, named, taken
from tests.outputs.recorded import frames, record


def files(place: Place) -> Attempt:
    """A recording of frames and one of pictures, one of them damaged, read to the end."""
    packed = record(place.folder / "frames.mcap", frames(1.0))
    exact = record(place.folder / "exact.mcap", frames(0.2), exact=True)
    pictures = recorded_capture(place.folder)
    sound = [path.read_bytes() for path in (packed, exact, pictures)]
    target = place.folder / "damaged.mcap"

    def read(path: Path) -> bool:
        return named(lambda: list(RecordingReader(path).everything())) | named(
            lambda: _pictures(path)
        )

    for path in (packed, exact, pictures):
        assert read(path)

    def attempt(random: Random, number: int) -> bool:
        data = damaged(random, sound[number % len(sound)])
        if number % 5 == 4:  # between the records of an unpacked file everything is reached
            data = damaged(random, data)
        target.write_bytes(data)
        return read(target)

    return attempt


def _pictures(path: Path) -> bool:
    origin = open_recording(path)
    return taken(lambda: (from_origin(origin), list(origin.frame_sets())))
