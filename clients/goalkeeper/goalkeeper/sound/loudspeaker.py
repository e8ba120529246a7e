"""Plays what happens. Without a sound card it is silent, and the game goes on."""

from typing import Any

from panda3d.core import Filename, VirtualFileMountRamdisk, VirtualFileSystem

from goalkeeper.core.events import Conceded, Counted, Event, Kicked, RoundOver, Saved
from goalkeeper.sound import synth

_FOLDER = "/goalkeeper-sounds"


class Loudspeaker:
    """One sound of each kind, made at the start."""

    def __init__(self, base: Any) -> None:
        files = VirtualFileSystem.getGlobalPtr()
        files.mount(VirtualFileMountRamdisk(), _FOLDER, 0)
        made = {
            "kick": synth.kick(),
            "slap": synth.slap(),
            "net": synth.net(),
            "cheer": synth.cheer(),
            "groan": synth.groan(),
            "beep": synth.beep(high=False),
            "go": synth.beep(high=True),
            "whistle": synth.whistle(),
            "murmur": synth.murmur(),
        }
        self._sounds: dict[str, Any] = {}
        for name, samples in made.items():
            place = Filename(f"{_FOLDER}/{name}.wav")
            files.writeFile(place, synth.wav(samples), False)
            self._sounds[name] = base.loader.loadSfx(place)
        self._sounds["murmur"].setLoop(True)
        self._sounds["murmur"].play()

    def set_volume(self, volume: float) -> None:
        """Of everything, 0..1."""
        for sound in self._sounds.values():
            sound.setVolume(volume)

    def heard(self, events: list[Event]) -> None:
        """What happened since the last picture."""
        for event in events:
            for name in _sounds_of(event):
                self._sounds[name].play()


def _sounds_of(event: Event) -> tuple[str, ...]:
    match event:
        case Kicked():
            return ("kick",)
        case Saved():
            return ("slap", "cheer")
        case Conceded():
            return ("net", "groan")
        case Counted(number=number):
            return ("beep",) if number else ("go",)
        case RoundOver():
            return ("whistle",)
        case _:
            return ()
