"""A scenario's film as the origin of simulated webcams."""

import logging

import pytest

from mocapd.capture.simulated.film_origin import FilmOrigin
from mocapd.capture.source_request import SourceRequest
from mocapd.errors import ConfigError
from tests.capture.films import numbered_sim_film


def test_its_cameras_begin_together_when_the_first_is_opened(
    caplog: pytest.LogCaptureFixture,
) -> None:
    film = numbered_sim_film()
    origin = FilmOrigin("sim:x", film)
    names = origin.rig.names
    sources = [origin.source(f"sim:x#{name}", SourceRequest()) for name in names]
    with caplog.at_level(logging.INFO):
        assert "of the monotonic clock" not in caplog.text
        for source in sources:
            source.open()
    assert caplog.text.count("of the monotonic clock") == 1
    frames = [source.read() for source in sources]
    for source in sources:
        source.close()
    offsets_s = [camera.clock_offset_s for camera in film.scenario.cameras]
    exposed_s = [frame.t_ns / 1e9 - s for frame, s in zip(frames, offsets_s, strict=True)]
    periods = (exposed_s[-1] - exposed_s[0]) * origin.fps_hz
    assert periods == pytest.approx(round(periods), abs=1e-3)


def test_a_frame_set_has_every_camera_and_the_films_own_files() -> None:
    film = numbered_sim_film()
    sets = list(FilmOrigin("sim:x", film).frame_sets())
    assert len(sets) == FilmOrigin("sim:x", film).count
    for i, one in enumerate(sets):
        assert tuple(one.frames) == tuple(film.frames)
        assert all(frame.encoded is film.frames[name][i] for name, frame in one.frames.items())


def test_its_cameras_decode_as_small_as_is_asked_for() -> None:
    origin = FilmOrigin("sim:x", numbered_sim_film())
    source = origin.source(f"sim:x#{origin.rig.names[0]}", SourceRequest(reduced_by=2))
    source.open()
    frame = source.read()
    source.close()
    small, by = frame.small(4)
    assert by == 2
    assert small.shape[:2] == (frame.size_px[1] // 2, frame.size_px[0] // 2)


def test_a_camera_that_it_has_not_or_of_another_size_is_told() -> None:
    origin = FilmOrigin("sim:x", numbered_sim_film())
    with pytest.raises(ConfigError, match="no camera 'nobody'"):
        origin.source("sim:x#nobody", SourceRequest())
    with pytest.raises(ConfigError, match="1x1"):
        origin.source(f"sim:x#{origin.rig.names[0]}", SourceRequest(size_px=(1, 1)))
