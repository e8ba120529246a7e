"""A file that a command writes replaces none that is there without --force, and never one that the command reads."""

import os
from pathlib import Path

import pytest

from mocapd.calibrate.extrinsics.rig_writing import RIG
from mocapd.calibration.calibration_writing import CALIBRATION_KIND
from mocapd.errors import CannotCreateError
from mocapd.exports.formats import KINDS
from mocapd.output_file import PDF, PNG, FileKind, OutputFile
from mocapd.session.offline import track_file

MCAP = b"\x89MCAP0\r\n\x00"
TRACK = track_file(Path("a")).kind
# what a command writes, and how a file of it begins
BEGINNINGS: dict[FileKind, bytes] = {
    PDF: b"%PDF-1.4\n",
    PNG: b"\x89PNG\r\n\x1a\n",
    RIG: b'{\n "schema": "mocapd.Rig.v1",\n "cameras": [',
    CALIBRATION_KIND: b"# The calibration\n\nschema = 1\n",
    TRACK: b"PK\x03\x04" + bytes(26) + b"schema.npy",
    KINDS["bvh"]: b"HIERARCHY\nROOT hips\n",
    KINDS["glb"]: b"glTF\x02\0\0\0",
    KINDS["csv"]: b"time_s,gap,hips_x\n",
    KINDS["trc"]: b"PathFileType\t4\t(X/Y/Z)\ta.trc\n",
    KINDS["c3d"]: b"\x02\x50" + bytes(20),
}
# what must stay, whatever is written
FOREIGN = (
    MCAP,
    b"my notes",
    b"PK\x03\x04" + bytes(26) + b"times.npy ",  # a capture's truth.npz
    b"\0\0\0\x20ftypisom",
    b'{"name": "package"}',
    b"[tool]\nname = 'x'\n",
    b"\x7fELF",
)


def write(out: OutputFile, data: bytes = b"new") -> None:
    with out.writing() as partial:
        partial.write_bytes(data)


@pytest.mark.parametrize("kind", BEGINNINGS, ids=lambda kind: kind.name)
def test_no_file_is_replaced_without_force(tmp_path: Path, kind: FileKind) -> None:
    path = tmp_path / "out"
    for head in (b"", *FOREIGN, *BEGINNINGS.values()):
        path.write_bytes(head)
        is_kind = not head or head == BEGINNINGS[kind]
        match = r"is there already -- .*--force" if is_kind else "is there already, and is not a"
        with pytest.raises(CannotCreateError, match=match) as caught:
            write(OutputFile(path, kind))
        assert caught.value.fix == "choose another name with --out, or replace it with --force"
        with pytest.raises(CannotCreateError, match="is there already"):
            OutputFile(path, kind).check()
        assert path.read_bytes() == head
        OutputFile(path, kind, force=True).check()
        write(OutputFile(path, kind, force=True))
        assert path.read_bytes() == b"new"
    assert os.listdir(tmp_path) == ["out"]  # noqa: PTH208 (names, hidden ones too)


def test_a_file_that_an_argument_names_is_refused_without_naming_an_option(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    path.write_bytes(MCAP)
    with pytest.raises(CannotCreateError, match="-- choose another name, or replace it") as caught:
        OutputFile(path, PDF, option="").check()
    assert "--out" not in str(caught.value)


@pytest.mark.parametrize("force", [False, True])
def test_what_the_command_reads_is_never_replaced(tmp_path: Path, force: bool) -> None:
    source, hard, soft = (tmp_path / name for name in ("a.pdf", "hard.pdf", "soft.pdf"))
    source.write_bytes(b"%PDF-1.4")
    hard.hardlink_to(source)
    soft.symlink_to(source)
    for path in (source, hard, soft):
        with pytest.raises(CannotCreateError, match="is what the command reads"):
            write(OutputFile(path, PDF, force, inputs=(source,)))


def test_force_spares_what_lies_in_a_folder_that_is_read(tmp_path: Path) -> None:
    capture = tmp_path / "capture"
    capture.mkdir()
    (capture / "cam0.mp4").write_bytes(FOREIGN[3])
    with pytest.raises(CannotCreateError, match="is there already"):
        write(OutputFile(capture / "cam0.mp4", PDF, force=True, inputs=(capture,)))
    write(OutputFile(capture / "new.pdf", PDF, inputs=(capture,)))
    (capture / "new.pdf").write_bytes(b"%PDF-1.4")
    write(OutputFile(capture / "new.pdf", PDF, force=True, inputs=(capture,)))


@pytest.mark.parametrize("force", [False, True])
@pytest.mark.parametrize("kind", ["pipe", "folder", "device", "link to nothing"])
def test_what_is_no_file_is_never_replaced(tmp_path: Path, kind: str, force: bool) -> None:
    path = tmp_path / "out.pdf"
    match kind:
        case "pipe":
            os.mkfifo(path)
        case "folder":
            path.mkdir()
        case "device":
            path.symlink_to("/dev/null")
        case _:
            path.symlink_to(tmp_path / "share" / "out.pdf")
    with pytest.raises(CannotCreateError, match="is there already"):
        write(OutputFile(path, PDF, force))


def test_what_comes_while_the_file_is_written_stays(tmp_path: Path) -> None:
    path = tmp_path / "out.pdf"

    def write_slowly() -> None:
        with OutputFile(path, PDF).writing() as partial:
            partial.write_bytes(b"%PDF-")
            path.write_text("somebody else's")

    with pytest.raises(CannotCreateError, match="is there already"):
        write_slowly()
    assert path.read_text() == "somebody else's"


def test_a_folder_that_is_not_there_is_told_before_the_work(tmp_path: Path) -> None:
    with pytest.raises(CannotCreateError, match="cannot be written"):
        OutputFile(tmp_path / "none" / "out.pdf", PDF).check()


def test_a_name_that_is_too_long_is_not_said_to_be_there(tmp_path: Path) -> None:
    with pytest.raises(CannotCreateError, match="File name too long") as caught:
        OutputFile(tmp_path / ("x" * 300), PDF).check()
    assert "is there already" not in str(caught.value)
