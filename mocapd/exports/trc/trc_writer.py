"""Motion as TRC: joints as markers, tab-separated text, as OpenSim reads it.

Millimetres; axes as in mocapd, +Y up, which equal OpenSim's. A joint in a gap is empty, which readers take for a missing
marker.
"""

from pathlib import Path

from mocapd.exports.sampled_motion import SampledMotion

MM = 1000.0
_HEADER_LINES = 6


def trc_text(motion: SampledMotion, name: str) -> str:
    """The whole file; `name`: the file name, which the header repeats."""
    names = motion.skeleton.names
    count, rate = len(motion.joints_m), f"{motion.rate_hz:.10g}"
    empty = "\t" * (3 * len(names) - 1)
    lines = [
        f"PathFileType\t4\t(X/Y/Z)\t{name}",
        "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames",
        f"{rate}\t{rate}\t{count}\t{len(names)}\tmm\t{rate}\t1\t{count}",
        "Frame#\tTime\t" + "\t\t\t".join(names) + "\t\t",
        "\t\t" + "\t".join(f"X{i}\tY{i}\tZ{i}" for i in range(1, len(names) + 1)),
        "",
    ]
    rows_mm = (motion.joints_m * MM).reshape(count, -1).tolist()
    for number, (time_s, gap, row) in enumerate(
        zip(motion.times_s.tolist(), motion.gap.tolist(), rows_mm, strict=True), start=1
    ):
        places = empty if gap else "\t".join(f"{number_mm:.4f}" for number_mm in row)
        lines.append(f"{number}\t{time_s:.6f}\t{places}")
    return "\n".join([*lines, ""])


def frames_in_trc(path: Path) -> int:
    """The number of frames in a file of ours: as its header says, or fewer where lines are missing."""
    with path.open(encoding="utf-8") as file:
        header = [next(file) for _ in range(_HEADER_LINES)]
        return min(int(header[2].split("\t")[2]), sum(1 for _ in file))
