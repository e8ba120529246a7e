"""The frontal-face cascade: boosted multi-block LBP features in the file format of OpenCV.

Liao et al., Learning Multi-scale Block Local Binary Patterns for Face Recognition, ICB 2007. The trained file is OpenCV's for
frontal faces (Apache-2.0); OpenCV 5 has lost the class that reads it.
"""

from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from mocapd.published.hecht2009.face.lbp_cascade_kernels import CascadeArrays

_FILE = Path(__file__).with_name("lbpcascade_frontalface.xml")


def frontal_faces() -> CascadeArrays:
    """The cascade that comes with mocapd."""
    return read_cascade(_FILE)


def read_cascade(path: Path) -> CascadeArrays:
    """The cascade in an OpenCV XML file with LBP features of stumps. ValueError: it is something else."""
    root = ElementTree.fromstring(path.read_bytes()).find("cascade")
    if root is None or root.findtext("featureType", "").strip() != "LBP":
        raise ValueError(f"{path} has no cascade of LBP features")
    rects = np.array([_numbers(node.findtext("rect")) for node in root.iterfind("features/_")])
    first, threshold, used, subsets, leaves = [0], [], [], [], []
    for stage in root.iterfind("stages/_"):
        threshold.append(float(stage.findtext("stageThreshold", "nan")))
        for weak in stage.iterfind("weakClassifiers/_"):
            node = _numbers(weak.findtext("internalNodes"))
            if len(node) != 11:
                raise ValueError(f"{path} has trees deeper than stumps")
            used.append(int(node[2]))
            subsets.append([int(word) & 0xFFFFFFFF for word in node[3:]])
            leaves.append(_numbers(weak.findtext("leafValues")))
        first.append(len(used))
    return CascadeArrays(
        first=np.array(first, np.int64),
        threshold=np.array(threshold, np.float32),
        rects=rects[used].astype(np.int64),
        subsets=np.array(subsets, np.uint32),
        leaves=np.array(leaves, np.float32),
    )


def _numbers(text: str | None) -> list[float]:
    return [float(word) for word in (text or "").split()]
