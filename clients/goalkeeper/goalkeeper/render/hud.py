"""What is written over the picture: score, clock, streak, level, keys, latency, messages. Text is laid out anew only when it
changes: that costs more than drawing it. All of it lies on dark panels, and follows the window's shape."""

from typing import Any

from panda3d.core import CardMaker, NodePath, TextNode, TransparencyAttrib

from goalkeeper.render.hud_lines import HudText

_INK = (0.96, 0.97, 0.98, 1.0)
_AMBER = (1.0, 0.72, 0.22, 1.0)
_PANEL = (0.02, 0.03, 0.06, 0.72)
_BAR_HEIGHT = 0.085  # of the keys, at the bottom
_FONT = "cmss12"  # of Panda3D; a zero of its built-in font is a letter O


class Hud:
    """On Panda3D's two-dimensional scene, whose height is -1..1."""

    def __init__(self, base: Any) -> None:
        self._font = base.loader.loadFont(_FONT)
        self._base, self._aspect = base, 0.0
        self._root = base.aspect2d.attachNewNode("hud")
        _panel(self._root, (-0.62, 0.62, 0.835, 0.985))
        self._bar_back = _panel(self._root, (-0.25, 0.25, 0.805, 0.822))
        self._bar = _panel(self._root, (0.0, 0.5, 0.805, 0.822), _AMBER)
        self._bar.setX(-0.25)
        self._foot_bar = _panel(self._root, (-1.0, 1.0, -1.0, -1.0 + _BAR_HEIGHT))
        self._score = self._line((-0.57, 0.875), 0.085, TextNode.ALeft, _INK)
        self._clock = self._line((0.0, 0.872), 0.095, TextNode.ACenter, _INK)
        self._streak = self._line((0.57, 0.875), 0.085, TextNode.ARight, _AMBER)
        self._foot = self._line((0.0, -0.972), 0.052, TextNode.ARight, _INK)
        self._keys = self._line((0.0, -0.972), 0.052, TextNode.ALeft, _INK)
        self._big = self._line((0.0, 0.10), 0.42, TextNode.ACenter, _INK)
        self._message = self._line((0.0, 0.62), 0.075, TextNode.ACenter, _INK, backed=True)
        self._popup = self._line((-0.85, 0.36), 0.12, TextNode.ACenter, _AMBER, backed=True)
        self._table = self._line((0.0, 0.52), 0.072, TextNode.ACenter, _INK, backed=True)

    def show(self, text: HudText) -> None:
        """Once a picture."""
        aspect = self._base.getAspectRatio()
        if aspect != self._aspect:  # the window has another shape
            self._aspect = aspect
            self._foot.move(aspect - 0.04)
            self._keys.move(0.04 - aspect)
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

    def _line(
        self,
        at: tuple[float, float],
        size: float,
        align: object,
        colour: tuple[float, ...],
        *,
        backed: bool = False,
    ) -> "_Line":
        line = _Line(self._root, at, size, align, colour)
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
        root: NodePath,
        at: tuple[float, float],
        size: float,
        align: object,
        colour: tuple[float, ...],
    ) -> None:
        self.node = TextNode("line")
        self.node.setAlign(align)
        self.node.setTextColor(*colour)
        self.node.setShadow(0.05, 0.05)
        self.node.setShadowColor(0.0, 0.0, 0.0, 0.85)
        self._path = root.attachNewNode(self.node)
        self._path.setScale(size)
        self._path.setPos(at[0], 0.0, at[1])
        self._path.setTransparency(TransparencyAttrib.MAlpha)
        self._path.setBin("fixed", 20)
        self._text = ""

    def write(self, text: str) -> None:
        if text != self._text:
            self._text = text
            self.node.setText(text)

    def move(self, x: float) -> None:
        self._path.setX(x)


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
