"""The body model in the wearer's proportions, made again only when those change."""

from typing import NamedTuple

from mocapd.body.model import BodyModel, shaped
from mocapd.types import Floats


class Shaped(NamedTuple):
    """T-pose vertices (V,3), joints `rest` (J,3) and centres of the triangles (T,3) [m]."""

    vertices: Floats
    rest: Floats
    centres: Floats


class Shaper:
    """Shapes one body; remembers the last factors, which rarely change from one call to the next."""

    def __init__(self, model: BodyModel) -> None:
        self.model = model
        self._factors = b""  # compared as bytes: np.array_equal takes twenty times as long
        self._shaped = Shaped(model.vertices_m, model.rest_m, model.centres_m)

    def __call__(self, factors: Floats) -> Shaped:
        """The body with these factors (n_shape,). The arrays are not to be written to."""
        asked = factors.tobytes()
        if asked != self._factors:
            m = self.model
            vertices, rest = shaped(m, factors)
            offset = (factors - 1.0) @ m.d_centres.reshape(len(factors), -1)
            self._shaped = Shaped(vertices, rest, m.centres_m + offset.reshape(-1, 3))
            self._factors = asked
        return self._shaped
