"""One token of a file repeated very often: what a parser does for each must stay cheap."""

from collections.abc import Callable, Sequence
from datetime import UTC, datetime
from pathlib import Path
from random import Random

from mcap.writer import Writer

from mocapd.assets import asset_path
from mocapd.calibration.calibration_file import read_calibration
from mocapd.config.effective import load_config
from mocapd.geometry.rig_file import load_rig
from mocapd.outputs.mcap.recording_reader import RecordingReader
from mocapd.outputs.vmc.vrm_file import read_vrm
from mocapd.sim.scenario import load_scenario
from mocapd.wizard.intrinsics.saved_intrinsics import FILE_NAME as LENSES
from mocapd.wizard.intrinsics.saved_intrinsics import read_intrinsics, store_intrinsics
from mocapd.wizard.saving import save_draft
from tests.capture.films import write_capture
from tests.fuzz.avatars import with_json
from tests.fuzz.configs import CONFIG
from tests.fuzz.mutations import repeated
from tests.fuzz.row import Attempt, Place, taken
from tests.outputs.recorded import frames, record
from tests.outputs.vmc.vrm_models import glb, model
from tests.wizard.drafts import full_draft

_TOML = (
    b"a.", b"'a'.", b'"a".', b"a . ", b"[a.a]\n", b"[[camera]]\n", b"[[camera]]\nid = 'a'\nsource = '0'\n", b"[],", b"{},",
    b"[", b"{a=", b"a=1\n", b"#\n", b"\n", b'"""', b'\\"', b"\\u0041", b"9", b"1,", b"1979-05-27,", b"'",
)  # fmt: skip
_JSON = (
    b"[],", b"{},", b"1,", b"[", b'{"a":', b"9", b" ", b'"a":1,', b'"\\u0041",', b'{"children":[1]},', b'{"matrix":[1]},',
    b"\\\\", b"null,", b'{"bone":"hips","node":1},',
)  # fmt: skip


def rigs(place: Place) -> Attempt:
    """rig.json of a capture."""
    path = write_capture(place.folder / "capture", frames=(1, 1)) / "rig.json"
    return _file(path, _JSON, load_rig)


def calibrations(place: Place) -> Attempt:
    """calibration.toml."""
    return _file(save_draft(full_draft(), place.folder), _TOML, read_calibration)


def lenses(place: Place) -> Attempt:
    """lenses.toml."""
    store_intrinsics(full_draft(), place.folder, datetime(2026, 11, 22, tzinfo=UTC))
    return _file(place.folder / LENSES, _TOML, lambda path: read_intrinsics(path.parent))


def configs(place: Place) -> Attempt:
    """config.toml."""
    path = place.folder / "config.toml"
    path.write_text(CONFIG)
    return _file(path, _TOML, lambda path: load_config(file=path, env={}))


def scenarios(place: Place) -> Attempt:
    """A scenario of the simulator."""
    path = place.folder / "scenario.toml"
    path.write_bytes(asset_path("scenarios/living_room.toml").read_bytes())
    return _file(path, _TOML, load_scenario)


def avatars(place: Place) -> Attempt:
    """The JSON of a `.vrm`, up to all that is read of it."""
    path = place.folder / "avatar.vrm"
    goods = [glb(model(version).document()) for version in (0, 1)]
    path.write_bytes(goods[0])
    read_vrm(path)

    def attempt(random: Random, number: int) -> bool:
        good = goods[number % 2]
        most = random.choice((100_000, 4_000_000))
        path.write_bytes(with_json(good, lambda text: repeated(random, text, _JSON, most)))
        return taken(lambda: read_vrm(path))

    return attempt


def recordings(place: Place) -> Attempt:
    """Records of a recording, by themselves and packed into chunks."""
    path = record(place.folder / "frames.mcap", frames(0.5))
    sound = path.read_bytes()
    tokens = (_message(b""), _message(b"\x80"), sound[:60], b"\0" * 9)
    packed = place.folder / "packed.mcap"

    def read(path: Path) -> bool:
        return taken(lambda: list(RecordingReader(path).everything()))

    assert read(path)

    def attempt(random: Random, number: int) -> bool:
        if number % 2:
            path.write_bytes(repeated(random, sound, tokens))
            return read(path)
        _write_chunk(packed, random)
        return read(packed)

    return attempt


def _write_chunk(path: Path, random: Random) -> None:
    """Chunks of very many small messages, or of few large ones that shrink to nothing."""
    many = round(30_000 ** random.random())
    size = random.choice((0, 1, 100, 10_000, 1 << 20)) if many < 60 else random.choice((0, 1, 30))
    with path.open("wb") as file:
        writer = Writer(file, chunk_size=random.choice((1 << 14, 1 << 22, 1 << 26)))
        writer.start()
        schema = writer.register_schema("mocapd.Skeleton.v1", "jsonschema", b"")
        channel = writer.register_channel("/a", "msgpack", schema)
        for at in range(many):
            writer.add_message(channel, at, bytes(size), at)
        writer.finish()


def _message(data: bytes) -> bytes:
    """One record as it stands in a file."""
    return b"\x05" + (22 + len(data)).to_bytes(8, "little") + b"\x01" + bytes(21) + data


def _file(path: Path, tokens: Sequence[bytes], read: Callable[[Path], object]) -> Attempt:
    good = path.read_bytes()
    read(path)

    def attempt(random: Random, number: int) -> bool:
        path.write_bytes(repeated(random, good, tokens, random.choice((4_000, 60_000, 900_000))))
        return taken(lambda: read(path))

    return attempt
