"""What is written over the picture: score, clock, streak, level, latency, messages. Text is laid out anew only when it
changes: that costs more than drawing it."""

from typing import Any

from panda3d.core import CardMaker, NodePath, TextNode, TransparencyAttrib

from goalkeeper.render.hud_lines import HudText

_INK = (0.96, 0.97, 0.98, 1.0)
_AMBER = (1.0, 0.72, 0.22, 1.0)
_PANEL = (0.02, 0.03, 0.06, 0.62)


class Hud:
    """On Panda3D's two-dimensional scene, whose height is -1..1."""

    def __init__(self, base: Any) -> None:
        aspect = base.getAspectRatio()
        self._root = base.aspect2d.attachNewNode("hud")
        _panel(self._root, (-0.62, 0.62, 0.835, 0.985))
        self._bar_back = _panel(self._root, (-0.25, 0.25, 0.805, 0.822))
        self._bar = _panel(self._root, (0.0, 0.5, 0.805, 0.822), _AMBER)
        self._bar.setX(-0.25)
        self._table_back = _panel(self._root, (-0.62, 0.62, -0.62, 0.52), (0.02, 0.03, 0.06, 0.80))
        self._score = _Line(self._root, (-0.57, 0.875), 0.085, TextNode.ALeft, _INK)
        self._clock = _Line(self._root, (0.0, 0.872), 0.095, TextNode.ACenter, _INK)
        self._streak = _Line(self._root, (0.57, 0.875), 0.085, TextNode.ARight, _AMBER)
        self._foot = _Line(self._root, (aspect - 0.04, -0.965), 0.045, TextNode.ARight, _INK)
        self._keys = _Line(self._root, (-aspect + 0.04, -0.965), 0.045, TextNode.ALeft, _INK)
        self._big = _Line(self._root, (0.0, 0.10), 0.42, TextNode.ACenter, _INK)
        self._message = _Line(self._root, (0.0, 0.60), 0.085, TextNode.ACenter, _INK)
        self._popup = _Line(self._root, (0.0, 0.60), 0.13, TextNode.ACenter, _AMBER)
        self._table = _Line(self._root, (0.0, 0.40), 0.068, TextNode.ACenter, _INK)

    def show(self, text: HudText) -> None:
        """Once a picture."""
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
        (self._table_back.show if text.table else self._table_back.hide)()


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
        self._node = TextNode("line")
        self._node.setAlign(align)
        self._node.setTextColor(*colour)
        self._node.setShadow(0.05, 0.05)
        self._node.setShadowColor(0.0, 0.0, 0.0, 0.85)
        path = root.attachNewNode(self._node)
        path.setScale(size)
        path.setPos(at[0], 0.0, at[1])
        path.setBin("fixed", 20)
        self._text = ""

    def write(self, text: str) -> None:
        if text != self._text:
            self._text = text
            self._node.setText(text)


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
