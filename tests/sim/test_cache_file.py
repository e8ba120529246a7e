"""What the simulator keeps: a file of which any byte has changed is none."""

import os
import random
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import msgspec
import pytest

from mocapd.sim.cache_file import cache_path, read_cached, read_or_make, write_cached


class Kept(msgspec.Struct, frozen=True):
    key: str
    first: int
    frames: dict[str, list[bytes]]


KEPT = Kept("0123456789abcdef", 3, {"left": [b"\xff\xd8" * 40, b""], "right": [bytes(range(256))]})


@pytest.fixture
def path(tmp_path: Path) -> Path:
    path = tmp_path / "cache" / "a.film"
    write_cached(path, KEPT)
    return path


def test_what_was_written_is_read_when_its_key_fits(path: Path) -> None:
    assert read_cached(path, KEPT.key, Kept) == KEPT
    assert read_cached(path, "another", Kept) is None
    assert read_cached(path.with_name("none"), KEPT.key, Kept) is None
    assert path.parent.stat().st_mode & 0o777 == 0o700


def test_any_changed_byte_is_found(path: Path) -> None:
    """1,190 of 5,002 changed films were tracebacks at each start, 1,353 gave other pictures."""
    whole = path.read_bytes()
    rng = random.Random(8)
    for place in {*range(64), *(rng.randrange(len(whole)) for _ in range(200))}:
        data = bytearray(whole)
        data[place] ^= rng.randrange(1, 256)
        path.write_bytes(data)
        assert read_cached(path, KEPT.key, Kept) is None
    for length in range(0, len(whole), 7):
        path.write_bytes(whole[:length])
        assert read_cached(path, KEPT.key, Kept) is None
    path.write_bytes(whole + b"\0")
    assert read_cached(path, KEPT.key, Kept) is None


def test_of_two_who_need_it_at_once_one_makes_it(tmp_path: Path) -> None:
    both_asked, made = threading.Event(), []

    def make() -> Kept:
        assert both_asked.wait(30.0)
        made.append(KEPT)
        return KEPT

    with ThreadPoolExecutor(2) as pool:
        both = [
            pool.submit(read_or_make, tmp_path / "cache", "a", KEPT.key, Kept, make)
            for _ in range(2)
        ]
        both_asked.set()
        assert [one.result() for one in both] == [KEPT, KEPT]
    assert len(made) == 1


def test_what_no_version_has_used_for_a_week_is_removed_when_something_new_is_made(
    tmp_path: Path,
) -> None:
    """Each upgrade left 42 MB."""

    def use(name: str, key: str) -> None:
        read_or_make(tmp_path, name, key, Kept, lambda: msgspec.structs.replace(KEPT, key=key))

    def kept() -> set[str]:
        return {path.stem for path in tmp_path.glob("*.film")}

    old, used, new = ("abcdefghijklmnop"[i:] + "0" * i for i in range(3))
    eight_days_ago_s = time.time() - 8 * 86_400
    made = (("a", old), ("a", used), ("a-b", old))
    for name, key in made:
        use(name, key)
    for name, key in made:
        os.utime(cache_path(tmp_path, name, key), (eight_days_ago_s, eight_days_ago_s))
    use("a", used)
    assert kept() == {f"a-{old}", f"a-{used}", f"a-b-{old}"}
    use("a", new)
    assert kept() == {f"a-{used}", f"a-{new}", f"a-b-{old}"}


def test_what_is_no_file_is_nothing(path: Path) -> None:
    path.unlink()
    os.mkfifo(path)
    assert read_cached(path, KEPT.key, Kept) is None
