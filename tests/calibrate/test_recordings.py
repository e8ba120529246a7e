"""Pictures of the board from a folder: every kind is read as OpenCV reads it, none takes the machine."""

import os
import struct
import subprocess
import sys
from pathlib import Path

import cv2
import numpy as np
import pytest

from mocapd.calibrate.board.board_recordings import find_recordings, read_picture
from mocapd.errors import InputError
from tests.capture.films import picture, write_film


@pytest.mark.parametrize("suffix", [".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff", ".webp"])
def test_every_kind_of_picture_is_read(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"0{suffix}"
    cv2.imwrite(str(path), picture(77))
    read = read_picture(path)
    assert read.dtype == np.uint8
    as_before = cv2.imread(str(path), cv2.IMREAD_COLOR)
    assert as_before is not None
    assert np.array_equal(read, as_before)


@pytest.mark.parametrize("suffix", [".png", ".tif"])
def test_of_sixteen_bits_the_upper_eight_are_read(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"0{suffix}"
    cv2.imwrite(str(path), picture(77).astype(np.uint16) * 257)
    assert np.array_equal(read_picture(path), picture(77))


@pytest.mark.parametrize("suffix", [".png", ".bmp"])
def test_a_file_that_speaks_of_gigabytes_is_refused_whatever_it_is_called(
    tmp_path: Path, suffix: str
) -> None:
    data = bytearray(cv2.imencode(".png", picture(5))[1].tobytes())
    data[data.index(b"IDAT") - 4 : data.index(b"IDAT")] = b"\xff\0\0\0"
    path = tmp_path / f"0{suffix}"
    path.write_bytes(data)
    with pytest.raises(InputError, match=r"0\.(png|bmp): has a chunk that is longer"):
        read_picture(path)


def test_a_huge_size_in_a_header_that_opencv_measures_is_refused(
    tmp_path: Path, clean_env: dict[str, str]
) -> None:
    data = bytearray(cv2.imencode(".bmp", picture(5))[1].tobytes())
    data[18:26] = struct.pack("<ii", 8000, 6000)
    path = tmp_path / "0.bmp"
    path.write_bytes(data)
    # in a process of its own: the limit is read while OpenCV is imported
    code = (
        "import sys; from pathlib import Path\n"
        "from mocapd.calibrate.board.board_recordings import read_picture\n"
        "from mocapd.errors import InputError\n"
        "try:\n    read_picture(Path(sys.argv[1]))\n"
        "except InputError as error:\n    print(error)\n"
    )
    env = {k: v for k, v in clean_env.items() if not k.startswith("OPENCV_")}
    command = [sys.executable, "-c", code, str(path)]
    done = subprocess.run(command, env=env, capture_output=True, text=True, check=True)
    assert "0.bmp: cannot be decoded" in done.stdout


def test_what_is_no_file_is_not_waited_for(tmp_path: Path) -> None:
    (tmp_path / "cam0").mkdir()
    os.mkfifo(tmp_path / "cam0" / "0.png")
    with pytest.raises(InputError, match="no regular file"):
        find_recordings(tmp_path)


def test_what_is_no_picture_is_an_input_error(tmp_path: Path) -> None:
    path = tmp_path / "0.tif"
    for content in (b"", b"no picture", b"II*\0" + bytes(50)):
        path.write_bytes(content)
        with pytest.raises(InputError, match=r"0\.tif"):
            read_picture(path)


def test_what_other_systems_leave_in_a_folder_is_passed_over(tmp_path: Path) -> None:
    write_film(tmp_path / "left.avi", 3)
    (tmp_path / "right").mkdir()
    cv2.imwrite(str(tmp_path / "right" / "1.png"), picture(1))
    for name in ("._left.avi", "._right", ".DS_Store", "Thumbs.db", "desktop.ini"):
        (tmp_path / name).write_bytes(b"none of ours")
    for folder in (".Trash-1000", "__MACOSX", "@eaDir", "right/.thumbs"):
        (tmp_path / folder).mkdir()
        cv2.imwrite(str(tmp_path / folder / "1.png"), picture(1))
    (tmp_path / "right" / "._1.png").write_bytes(b"none of ours")
    assert [(one.name, one.frames) for one in find_recordings(tmp_path)] == [
        ("left", 3),
        ("right", 1),
    ]


def test_what_is_there_but_no_recording_is_named(tmp_path: Path) -> None:
    (tmp_path / "left.heic").touch()
    (tmp_path / "right").mkdir()
    with pytest.raises(
        InputError, match=r"no recording in it that can be read, but left\.heic, right"
    ):
        find_recordings(tmp_path)
