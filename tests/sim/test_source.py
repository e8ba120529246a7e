"""The simulated webcam as a `Source`: time stamps, numbers, drops, close, and the film behind it."""

import threading
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

import mocapd.sim.film
from mocapd.capture.simulated.film_origin import FilmOrigin
from mocapd.capture.simulated.sim import SimSource
from mocapd.clock import monotonic_ns
from mocapd.errors import CameraLost, CannotCreateError, ConfigError
from mocapd.sim.film import Film, film_key, first_frame, load_beginning, load_film
from tests.sim.small import renderers, scenario, table

PERIOD_NS = 1e9 / 30


@pytest.fixture(scope="module")
def cache(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("cache")


@pytest.fixture(scope="module")
def film(cache: Path) -> Film:
    return load_film(scenario(), cache)


def test_frames_come_in_order_stamped_at_mid_exposure(film: Film) -> None:
    source = SimSource(film, "left")
    source.open()
    frames = [source.read() for _ in range(5)]
    source.close()
    assert frames[0].seq == 0
    for frame in frames:
        assert frame.camera == "left"
        assert frame.pixels.shape == (120, 160, 3)
        assert frame.pixels.dtype == np.uint8
        assert not frame.pixels.flags.writeable
        assert frame.t_ns <= monotonic_ns()
        shift = (frame.t_ns - frames[0].t_ns) / PERIOD_NS
        assert shift == pytest.approx(frame.seq, abs=1e-3)
    assert all(b.seq > a.seq for a, b in pairwise(frames))


def test_the_second_camera_is_late_by_its_clock_offset(film: Film) -> None:
    left, right = SimSource(film, "left", epoch_ns=77), SimSource(film, "right", epoch_ns=77)
    for n in (0, 1, 1000, 10_000_000):
        assert right.exposure_ns(n) - left.exposure_ns(n) == 11_000_000
        assert left.exposure_ns(n + 30) - left.exposure_ns(n) == 1_000_000_000


def test_dropped_frames_leave_gaps_and_follow_from_the_seed(film: Film) -> None:
    right, again = SimSource(film, "right"), SimSource(film, "right")
    drops = [right.drops(n) for n in range(1000)]
    assert drops == [again.drops(n) for n in range(1000)]
    assert 0.25 < np.mean(drops) < 0.35
    assert not any(SimSource(film, "left").drops(n) for n in range(100))
    right.open()
    first = right.read()
    n0 = round((first.t_ns - right.exposure_ns(0)) / PERIOD_NS) - first.seq
    for _ in range(5):
        assert not right.drops(n0 + right.read().seq)
    right.close()


def test_a_late_reader_gets_the_newest_frame(film: Film) -> None:
    source = SimSource(film, "left")
    source.open()
    first = source.read()
    threading.Event().wait(0.2)
    before = monotonic_ns()
    late = source.read()
    assert late.seq - first.seq >= 4
    assert before - late.t_ns < 2 * PERIOD_NS + 5_000_000
    source.close()


def test_the_picture_is_that_of_the_stamped_moment_of_the_loop(film: Film) -> None:
    source = SimSource(film, "left", epoch_ns=monotonic_ns() - 60 * 1_000_000_000)
    source.open()
    frame = source.read()
    source.close()
    n = round((frame.t_ns - source.exposure_ns(0)) / PERIOD_NS)
    error = [
        np.abs(frame.pixels.astype(float) - renderers()[0].frame(f % 60)).mean()
        for f in (n, n + 15, n + 30)
    ]
    assert error[0] == min(error)
    assert error[0] < 4.0


def test_close_wakes_a_blocked_read_and_it_can_be_opened_again(film: Film) -> None:
    source = SimSource(film, "left", epoch_ns=monotonic_ns() + 3600 * 1_000_000_000)
    source.open()
    failures: list[Exception] = []

    def read() -> None:
        try:
            source.read()
        except CameraLost as error:
            failures.append(error)

    reader = threading.Thread(target=read)
    reader.start()
    source.close()
    source.close()
    reader.join(5.0)
    assert len(failures) == 1
    with pytest.raises(CameraLost):
        source.read()
    again = SimSource(film, "left")
    again.open()
    again.close()
    again.open()
    assert again.read().seq == 0


def test_an_unknown_camera_is_named_with_those_there_are(film: Film) -> None:
    with pytest.raises(ConfigError, match="middle") as caught:
        SimSource(film, "middle")
    assert "left" in caught.value.fix


def test_the_cache_is_used_and_a_damaged_one_is_rendered_anew(film: Film, cache: Path) -> None:
    calls: list[int] = []
    again = load_film(scenario(), cache, lambda done, total: calls.append(total))
    assert calls == []
    assert again.frames == film.frames
    assert np.array_equal(again.setup.scribbles["left"].pixels, film.setup.scribbles["left"].pixels)
    [path] = cache.glob("*.film")
    path.write_bytes(path.read_bytes()[:1000])
    mended = load_film(scenario(), cache, lambda done, total: calls.append(done))
    assert calls == list(range(1, 121))
    assert mended.frames == film.frames
    assert sorted(p.suffix for p in cache.iterdir()) == [".film", ".lock"]


def test_another_scenario_is_another_film() -> None:
    assert film_key(scenario()) == film_key(scenario())
    assert film_key(scenario()) != film_key(scenario(seed=6))


def test_films_begin_when_every_camera_sees_the_person() -> None:
    assert first_frame(scenario()) == 0
    assert first_frame(scenario(person_appears_s=0.5)) == 15


def test_an_unwritable_cache_is_an_error_with_a_fix(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    short = scenario(loop_s=0.3, lights=[], motion={"keyframes": [{"t_s": 0.0}]}, cameras=[_tiny()])
    with pytest.raises(CannotCreateError, match="cache"):
        load_film(short, tmp_path / "file" / "cache")


def _tiny() -> dict[str, object]:
    return {
        "name": "a",
        "position_m": [0.0, 1.3, 3.0],
        "look_at_m": [0.0, 1.0, 0.0],
        "size_px": [32, 24],
    }


def test_an_unplugged_camera_is_lost_and_comes_back(cache: Path) -> None:
    cameras = [dict(camera) for camera in table()["cameras"]]
    cameras[0]["outages"] = [{"from_s": 0.3, "to_s": 1.9}]
    film = load_film(scenario(name="outage", cameras=cameras, loop_s=2.0), cache)
    # frame n is exposed n periods after the epoch, so that frame 6 is due now
    source = SimSource(film, "left", epoch_ns=monotonic_ns() - round(6.5 * PERIOD_NS))
    source.open()
    assert [source.read().seq for _ in range(2)] == [0, 1]
    with pytest.raises(CameraLost, match="unplugged"):
        source.read()
    source.close()
    source = SimSource(film, "left", epoch_ns=monotonic_ns() - round(56.5 * PERIOD_NS))
    source.open()
    source.read()
    source.close()
    sets = list(FilmOrigin("sim:outage", film).frame_sets())
    alone = [i for i, one in enumerate(sets) if "left" not in one.frames]
    assert alone == list(range(9, 57))
    assert all("right" in one.frames for one in sets)


def test_the_beginning_of_a_film_goes_forth_and_back_until_the_whole_is_there(
    film: Film, cache: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(mocapd.sim.film, "BEGINNING_S", 0.2)
    beginning = load_beginning(scenario(), tmp_path)
    for name, frames in beginning.frames.items():
        assert frames == (*film.frames[name][:6], *film.frames[name][4:0:-1])
    assert load_beginning(scenario(), cache).frames == film.frames
