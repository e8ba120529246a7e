"""One camera's picture with its strokes on the page: for drawing, and with the solution's preview."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

from mocapd.errors import Problem
from mocapd.types import Bytes, LabelledPicture
from mocapd.wizard.colour.colour_solving import CameraSolution, StrokeDrawing
from mocapd.wizard.colour.stroke_images import encode_picture, encode_strokes
from mocapd.wizard.step import Json, Shape

SERVICE = "mocapd"  # author of proposed strokes


@dataclass(slots=True, eq=False)
class Canvas:
    """One camera's picture on the page; `serial` grows with every change of the strokes."""

    drawn: StrokeDrawing
    jpeg: bytes
    png: bytes
    by: str = SERVICE
    serial: int = 0

    def draw(self, strokes: Bytes, shirt: Bytes | None, by: str) -> None:
        self.drawn = StrokeDrawing(replace(self.drawn.picture, labels=strokes), shirt)
        self.png, self.by, self.serial = encode_strokes(strokes), by, self.serial + 1

    @property
    def size_px(self) -> tuple[int, int]:
        """Width and height of the picture."""
        height, width = self.drawn.picture.pixels.shape[:2]
        return width, height

    def details(
        self, base: str, solved: CameraSolution | None, solutions: int, pictures: dict[str, bytes]
    ) -> Json:
        """The page's data; adds the camera's pictures, with keys `base`..., to `pictures`.

        solutions: the number of solutions so far.
        """
        solved = solved or CameraSolution(self.drawn, ())
        picture, strokes = f"{base}.jpg", f"{base}-strokes-{self.serial}.png"
        pictures[picture], pictures[strokes] = self.jpeg, self.png
        preview = None
        if solved.preview is not None:
            # the bytes also change with the other cameras' strokes: the wearer's colours are common
            preview = f"{base}-seen-{solutions}.png"
            pictures[preview] = solved.preview
        return {
            "size": list(self.size_px),
            "picture": picture,
            "strokes": strokes,
            "by": self.by,
            "seen": preview,
            "ok": solved.W is not None,
            "marks": [list(p) for problem in solved.problems for p in problem.at_px],
            "alike": [
                {"name": lookalike.name, "at": lookalike.polygon_px.tolist()}
                for lookalike in solved.alike
            ],
            "note": solved.note,
        }


def canvas_of(picture: LabelledPicture) -> Canvas:
    """A canvas with these strokes on it."""
    return Canvas(
        StrokeDrawing(picture), encode_picture(picture.pixels), encode_strokes(picture.labels)
    )


def problems_of(solved: CameraSolution, camera: str) -> list[Problem]:
    return [Problem(problem.what, camera, problem.fix) for problem in solved.problems]


def outlines(solved: CameraSolution) -> Iterator[Shape]:
    """Outlines and names of things outside the wearer with the shirt's colours."""
    for lookalike in solved.alike:
        corners = tuple((float(x), float(y)) for x, y in lookalike.polygon_px)
        yield Shape("polygon", corners, "hint")
        yield Shape("text", corners[:1], "hint", lookalike.name)
