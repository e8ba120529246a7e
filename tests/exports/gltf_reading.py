"""A GLB file as numbers, read by pygltflib."""

from pathlib import Path
from typing import Any

import numpy as np
import pygltflib
from numpy.typing import NDArray

_DTYPES = {5126: "<f4", 5121: "|u1", 5123: "<u2"}
_WIDTHS = {"SCALAR": 1, "VEC3": 3, "VEC4": 4, "MAT4": 16}


def load(path: Path) -> Any:
    """The file."""
    file = pygltflib.GLTF2.load_binary(str(path))
    assert file is not None
    return file


def rows_of(file: Any, number: int) -> NDArray[Any]:
    """The rows of an accessor, as they are stored."""
    accessor = file.accessors[number]
    view = file.bufferViews[accessor.bufferView]
    data = file.binary_blob()[view.byteOffset : view.byteOffset + view.byteLength]
    return np.frombuffer(data, _DTYPES[accessor.componentType]).reshape(
        accessor.count, _WIDTHS[accessor.type]
    )
