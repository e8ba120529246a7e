"""A face that a cascade of three stages finds: a flat bright square, a third of the box wide, on something darker."""

from pathlib import Path

STAGES = (
    # rect of the top left block, and the code that passes: all blocks darker than the middle one, or none
    ((0, 0, 8, 8), "dark"),
    ((6, 6, 4, 4), "dark"),
    ((9, 9, 2, 2), "flat"),
)


def write_cascade(path: Path) -> Path:
    """The cascade in the format of OpenCV."""
    stages, features = "", ""
    for i, (rect, passes) in enumerate(STAGES):
        words = [1, *[0] * 7] if passes == "dark" else [*[0] * 7, -(2**31)]
        subset = " ".join(map(str, words))
        stages += (
            f"<_><maxWeakCount>1</maxWeakCount><stageThreshold>0.5</stageThreshold><weakClassifiers><_>"
            f"<internalNodes>0 -1 {i} {subset}</internalNodes><leafValues>1.0 -1.0</leafValues></_>"
            f"</weakClassifiers></_>"
        )
        features += f"<_><rect>{' '.join(map(str, rect))}</rect></_>"
    path.write_text(
        f'<?xml version="1.0"?><opencv_storage><cascade><featureType>LBP</featureType><stages>{stages}</stages>'
        f"<features>{features}</features></cascade></opencv_storage>"
    )
    return path
