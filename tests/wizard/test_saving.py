"""The draft as a file, and back."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from mocapd.errors import ConfigError, InputError
from mocapd.wizard.draft import Draft
from mocapd.wizard.saving import load_draft, save_draft
from tests.wizard.drafts import full_draft


def test_a_saved_draft_can_be_gone_on_with(tmp_path: Path) -> None:
    draft = full_draft()
    save_draft(draft, tmp_path / "new" / "folder")
    loaded = load_draft(tmp_path / "new" / "folder")
    assert loaded.cameras == draft.cameras
    assert loaded.board == draft.board
    assert (loaded.stature_m, loaded.personal, loaded.floor_known) == (1.72, True, True)
    assert draft.factors is not None
    assert loaded.factors is not None
    assert np.array_equal(loaded.factors, draft.factors)
    assert loaded.extrinsics_quality is not None
    assert draft.extrinsics_quality is not None
    assert np.isnan(loaded.extrinsics_quality.rms_px)
    assert loaded.extrinsics_quality.camera_rms_px == draft.extrinsics_quality.camera_rms_px
    assert loaded.intrinsics_saved == {"cam0", "cam1"}
    assert loaded.rig is not None
    assert draft.rig is not None
    for read, wrote in zip(loaded.rig.cameras, draft.rig.cameras, strict=True):
        for field in ("K", "dist", "R", "t_m"):
            assert np.array_equal(getattr(read, field), getattr(wrote, field))
    for name, colours in draft.colours.items():
        assert np.array_equal(loaded.colours[name].picture.pixels, colours.picture.pixels)
        assert np.array_equal(loaded.colours[name].picture.labels, colours.picture.labels)
        assert np.array_equal(loaded.colours[name].W, colours.W)


def test_without_colours_and_wearer_the_cameras_alone_are_kept(tmp_path: Path) -> None:
    draft = replace(full_draft(), colours={}, stature_m=None, factors=None, personal=False)
    save_draft(draft, tmp_path)
    loaded = load_draft(tmp_path)
    assert not loaded.colours
    assert loaded.stature_m is None


def test_more_pictures_of_a_lens_than_there_can_be_are_no_calibration(tmp_path: Path) -> None:
    path = save_draft(full_draft(), tmp_path)
    text = path.read_text()
    assert "views = 12" in text
    path.write_text(text.replace("views = 12", "views = 1000000000000"))
    with pytest.raises(ConfigError, match=path.name):
        load_draft(tmp_path)


def test_a_draft_without_a_room_is_not_saved(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="room"):
        save_draft(Draft(), tmp_path)
    assert not list(tmp_path.iterdir())
