"""Ground truth that is missing, damaged or of another kind gives one clear line."""

import io
import json
import zipfile
from pathlib import Path

import numpy as np
import pytest

from mocapd.body.bones import NAMES
from mocapd.errors import InputError
from mocapd.evaluate.truth import load_truth
from tests.evaluate.tracks import moving_truth


def write_truth(folder: Path) -> Path:
    truth = moving_truth()
    np.savez(
        folder / "truth.npz",
        times=truth.times_s,
        names=np.array(NAMES),
        joints=truth.joints_m.astype(np.float32),
        visible=truth.visible,
    )
    return folder


@pytest.mark.parametrize(
    ("info", "change_s"),
    [
        (None, None),
        ({"light_event": None}, None),
        ({"light_event": {"lamp_off_s": 5.5}}, 5.5),
        ({"light_events": {"warm": [[3.0, 1.0], [4.0, 0.0], [6.0, 1.0]], "cool": []}}, 4.0),
        ({"light_events": {"warm": [[0.8, 0.0], [1.4, 1.0]]}}, 0.8),
    ],
)
def test_the_time_of_a_lamp_going_out(
    info: dict[str, object] | None, change_s: float | None, tmp_path: Path
) -> None:
    write_truth(tmp_path)
    if info is not None:
        (tmp_path / "info.json").write_text(json.dumps(info))
    truth = load_truth(tmp_path)
    assert truth.light_change_s == change_s
    assert truth.names == NAMES
    assert np.array_equal(truth.visible, ~np.isnan(truth.joints_m[:, 0, 0]))


def test_a_capture_without_truth_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"truth\.npz: no ground truth.*mocapd track"):
        load_truth(tmp_path)


def test_a_truth_cut_short_is_named(tmp_path: Path) -> None:
    path = write_truth(tmp_path) / "truth.npz"
    path.write_bytes(path.read_bytes()[:2000])
    with pytest.raises(InputError, match=r"truth\.npz: cannot be read"):
        load_truth(tmp_path)


def npy_header(numbers: int) -> bytes:
    header = io.BytesIO()
    fields = {"descr": "<f8", "fortran_order": False, "shape": (numbers,)}
    np.lib.format.write_array_header_1_0(header, fields)
    return header.getvalue()


def test_an_array_that_is_no_archive_is_named(tmp_path: Path) -> None:
    (write_truth(tmp_path) / "truth.npz").write_bytes(npy_header(0))
    with pytest.raises(InputError, match=r"truth\.npz: cannot be read"):
        load_truth(tmp_path)


@pytest.mark.parametrize(
    ("numbers", "held_bytes", "what"),
    [(10**13, 0, "cannot be read"), (2**25, 2**28, "unpacks to more than 200 MB")],
    ids=["claims much", "holds much"],
)
def test_a_truth_of_another_size_is_named(
    numbers: int, held_bytes: int, what: str, tmp_path: Path
) -> None:
    path = write_truth(tmp_path) / "truth.npz"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as packed:
        packed.writestr("times.npy", npy_header(numbers) + bytes(held_bytes))
        for name in ("names", "joints", "visible"):
            packed.writestr(f"{name}.npy", npy_header(0))
    assert path.stat().st_size < 2_000_000
    with pytest.raises(InputError, match=rf"truth\.npz: {what}"):
        load_truth(tmp_path)


def test_a_truth_that_lacks_an_array_tells_which(tmp_path: Path) -> None:
    np.savez(tmp_path / "truth.npz", times=np.zeros(3), names=np.array(NAMES))
    with pytest.raises(InputError, match="lacks joints, visible"):
        load_truth(tmp_path)


def test_a_capture_in_which_nobody_is_seen_cannot_be_scored(tmp_path: Path) -> None:
    np.savez(
        tmp_path / "truth.npz",
        times=np.arange(3.0),
        names=np.array(NAMES),
        joints=np.full((3, len(NAMES), 3), np.nan),
        visible=np.zeros(3, dtype=bool),
    )
    with pytest.raises(InputError, match="nobody is visible"):
        load_truth(tmp_path)


@pytest.mark.parametrize("info", ["[]", '{"clear_s": null}', '{"light_event": 3}'])
def test_a_description_of_another_kind_is_named(info: str, tmp_path: Path) -> None:
    (write_truth(tmp_path) / "info.json").write_text(info)
    with pytest.raises(InputError, match=r"info\.json: .*lamps"):
        load_truth(tmp_path)


def test_a_compressed_truth_with_wrong_bytes_is_named(tmp_path: Path) -> None:
    path = write_truth(tmp_path) / "truth.npz"
    with np.load(path) as arrays:
        np.savez_compressed(path, **arrays)
    data = bytearray(path.read_bytes())
    data[100:110] = b"\xff" * 10
    path.write_bytes(data)
    with pytest.raises(InputError, match=r"truth\.npz: cannot be read.*decompressing"):
        load_truth(tmp_path)
