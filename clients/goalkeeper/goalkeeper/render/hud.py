"""What is written over the picture: score, clock, streak, level, keys, latency, messages, on dark panels. Text is laid out
anew only when it changes: that costs more than drawing it. What is wider than the window is drawn smaller, but for the keys,
which then take several lines."""

from typing import Any

from panda3d.core import CardMaker, NodePath, TextNode, TransparencyAttrib

from goalkeeper.render.hud_lines import HudText

_INK = (0.96, 0.97, 0.98, 1.0)
_AMBER = (1.0, 0.72, 0.22, 1.0)
_PANEL = (0.02, 0.03, 0.06, 0.72)
_BOTTOM = -0.972  # baseline of the lowest line
_BOTTOM_SIZE = 0.052
_LINE = 0.06  # from one line at the bottom to the next
_BAR_HEIGHT = 0.085  # of the keys, at the bottom, in one line
_LEAST_PX = 13  # height of a capital and what is below the line: the bottom's lines are larger in a low window
_SMALLEST = 0.8  # share of their size below which the keys take lines of their own
_EDGE = 0.04  # left free at each side
_TOP_WIDTH = 1.32  # of the panel with the score, and its edges
_FONT = "cmss12"  # of Panda3D; a zero of its built-in font is a letter O


class Hud:
    """Two-dimensional: height -1..1, width -aspect..aspect."""

    def __init__(self, base: Any) -> None:
        self._font = base.loader.loadFont(_FONT)
        self._base, self._aspect = base, 0.0
        self._bottom: tuple[float, int, str, str] | None = None  # for what the bottom was laid out
        # aspect2d scales itself another way in a window that is resized to a portrait
        self._root = base.render2d.attachNewNode("hud")
        self._top = self._root.attachNewNode("top")
        _panel(self._top, (-0.62, 0.62, 0.835, 0.985))
        _panel(self._top, (-0.25, 0.25, 0.805, 0.822))
        self._bar = _panel(self._top, (0.0, 0.5, 0.805, 0.822), _AMBER)
        self._bar.setX(-0.25)
        self._foot_bar = _panel(self._root, (-1.0, 1.0, 0.0, _BAR_HEIGHT))
        self._foot_bar.setZ(-1.0)
        top, root, centre = self._top, self._root, TextNode.ACenter
        self._score = self._line("score", top, (-0.57, 0.875), 0.085, TextNode.ALeft, _INK)
        self._clock = self._line("clock", top, (0.0, 0.872), 0.095, centre, _INK)
        self._streak = self._line("streak", top, (0.57, 0.875), 0.085, TextNode.ARight, _AMBER)
        low, small = (0.0, _BOTTOM), _BOTTOM_SIZE
        self._foot = self._line("foot", root, low, small, TextNode.ARight, _INK)
        self._keys = self._line("keys", root, low, small, TextNode.ALeft, _INK)
        self._big = self._line("big", root, (0.0, 0.10), 0.42, centre, _INK)
        self._message = self._line("message", root, (0.0, 0.62), 0.075, centre, _INK, backed=True)
        self._popup = self._line(
            "popup", root, (0.0, 0.36), 0.12, TextNode.ALeft, _AMBER, backed=True
        )
        self._table = self._line("table", root, (0.0, 0.52), 0.072, centre, _INK, backed=True)

    def show(self, text: HudText) -> None:
        """Once a picture."""
        aspect = self._base.getAspectRatio()
        if aspect != self._aspect:  # the window has another shape
            self._aspect = aspect
            self._root.setScale(1.0 / aspect, 1.0, 1.0)
            scale = min(1.0, 2.0 * aspect / _TOP_WIDTH)
            self._top.setScale(scale)
            self._top.setZ(1.0 - scale)
            self._foot.move(aspect - _EDGE)
            self._keys.move(_EDGE - aspect)
            self._foot_bar.setSx(aspect)
        self._score.write(text.score)
        self._clock.write(text.clock)
        self._streak.write(text.streak)
        self._foot.write(text.foot)
        self._keys.write(text.keys)
        self._big.write(text.big)
        self._message.write(text.message)
        self._popup.write(text.popup)
        self._table.write(text.table)
        self._bar.setSx(max(text.level, 0.001))
        self._fit()

    def _fit(self) -> None:
        """Makes texts smaller that would not fit into the window."""
        width = 2.0 * (self._aspect - _EDGE)
        self._fit_bottom(width)
        for line in (self._big, self._message, self._table):
            line.scale(min(1.0, (width - 2.0 * _EDGE) / max(line.width, 1e-6)))
        share = min(1.0, 0.6 * width / max(self._popup.width, 1e-6))
        self._popup.scale(share)
        self._popup.move(
            max(_EDGE - self._aspect + 2.0 * _EDGE, -0.85 - 0.5 * share * self._popup.width)
        )

    def _fit_bottom(self, width: float) -> None:
        """Keys and foot side by side; in a narrow window the keys in lines above the foot."""
        height_px = self._base.win.getYSize()
        laid = width, height_px, self._keys.text, self._foot.text
        if laid == self._bottom:
            return
        self._bottom = laid
        larger = max(1.0, _LEAST_PX / (0.5 * _BOTTOM_SIZE * height_px))
        self._keys.wrap(None)
        share = width / (larger * (self._keys.width + self._foot.width) + 2.0 * _EDGE)
        above = 0
        if share < _SMALLEST:
            self._keys.wrap(width / larger)
            above, share = self._keys.lines, 1.0
        share = larger * min(1.0, share)
        self._keys.scale(share)
        self._foot.scale(min(share, width / max(self._foot.width, 1e-6)))
        lowest = larger * (1.0 + _BOTTOM) - 1.0
        self._foot.raise_to(lowest)
        self._keys.raise_to(lowest + above * larger * _LINE)
        self._foot_bar.setSz(larger * (_BAR_HEIGHT + above * _LINE) / _BAR_HEIGHT)

    def _line(
        self,
        name: str,
        root: NodePath,
        at: tuple[float, float],
        size: float,
        align: object,
        colour: tuple[float, ...],
        *,
        backed: bool = False,
    ) -> "_Line":
        line = _Line(name, root, at, size, align, colour)
        line.node.setFont(self._font)
        if backed:
            line.node.setCardColor(*_PANEL)
            line.node.setCardAsMargin(0.5, 0.5, 0.3, 0.3)
            line.node.setCardDecal(True)
        return line


class _Line:
    """One text, with a dark edge that keeps it readable on everything."""

    def __init__(
        self,
        name: str,
        root: NodePath,
        at: tuple[float, float],
        size: float,
        align: object,
        colour: tuple[float, ...],
    ) -> None:
        self.node = TextNode(name)
        self.node.setAlign(align)
        self.node.setTextColor(*colour)
        self.node.setShadow(0.05, 0.05)
        self.node.setShadowColor(0.0, 0.0, 0.0, 0.85)
        self._path = root.attachNewNode(self.node)
        self._size, self._share = size, 1.0
        self._wrap: float | None = None
        self._path.setScale(size)
        self._path.setPos(at[0], 0.0, at[1])
        self._path.setTransparency(TransparencyAttrib.MAlpha)
        self._path.setBin("fixed", 20)
        self.text = ""

    def write(self, text: str) -> None:
        if text != self.text:
            self.text = text
            self.node.setText(text)

    @property
    def width(self) -> float:
        """At its usual size."""
        return float(self._size * self.node.getWidth())

    @property
    def lines(self) -> int:
        """How many it takes."""
        return int(self.node.getNumRows())

    def wrap(self, width: float | None) -> None:
        """Break it into lines of this width at its usual size, or take one line."""
        if width != self._wrap:
            self._wrap = width
            if width is None:
                self.node.clearWordwrap()
            else:
                self.node.setWordwrap(width / self._size)

    def scale(self, share: float) -> None:
        """Of its usual size."""
        if share != self._share:
            self._share = share
            self._path.setScale(share * self._size)

    def move(self, x: float) -> None:
        self._path.setX(x)

    def raise_to(self, z: float) -> None:
        """The baseline of its first line."""
        self._path.setZ(z)


def _panel(
    root: NodePath, frame: tuple[float, float, float, float], colour: tuple[float, ...] = _PANEL
) -> NodePath:
    maker = CardMaker("panel")
    maker.setFrame(*frame)
    maker.setColor(*colour)
    panel = root.attachNewNode(maker.generate())
    panel.setTransparency(TransparencyAttrib.MAlpha)
    panel.setBin("fixed", 10)
    return panel
