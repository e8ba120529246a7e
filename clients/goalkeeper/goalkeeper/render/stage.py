"""Opens Panda3D: a window or a picture in memory, on the graphics card or by its software renderer."""

from dataclasses import dataclass
from enum import StrEnum
from typing import Any

from direct.showbase.ShowBase import ShowBase
from panda3d.core import (
    AntialiasAttrib,
    FrameBufferProperties,
    GraphicsPipe,
    GraphicsPipeSelection,
    WindowProperties,
    loadPrcFileData,
)

from mocapd.errors import UnavailableError

_BY_PROCESSOR = ("llvmpipe", "softpipe", "swrast", "swiftshader", "software")


class Renderer(StrEnum):
    """Who draws. AUTO: the graphics card where there is one, else SOFTWARE."""

    AUTO = "auto"
    GL = "gl"
    SOFTWARE = "software"


@dataclass(frozen=True, slots=True)
class StageParams:
    """size_px: width, height; offscreen: without a window."""

    size_px: tuple[int, int] = (1280, 720)
    renderer: Renderer = Renderer.AUTO
    offscreen: bool = False
    fullscreen: bool = False
    sound: bool = True


@dataclass(frozen=True, slots=True)
class Stage:
    """Panda3D's own object, and whether the processor draws."""

    base: Any
    software: bool


def open_stage(params: StageParams) -> Stage:
    """Open it; once in a process. Raises UnavailableError where neither a window nor a picture can be had."""
    width, height = params.size_px
    loadPrcFileData("", f"""
        window-title Goalkeeper
        win-size {width} {height}
        audio-library-name {"p3openal_audio" if params.sound else "null"}
        sync-video {"#f" if params.offscreen else "#t"}
        framebuffer-multisample 1
        multisamples 4
        show-frame-rate-meter #f
        notify-level-device fatal
        notify-level-display fatal
        notify-level-x11display fatal
        notify-level-egldisplay fatal
        notify-level-audio fatal
        notify-level-openalAudio fatal
        load-display {"p3headlessgl" if params.offscreen else "pandagl"}
        aux-display p3tinydisplay
    """)  # fmt: skip
    base = ShowBase(windowType="none")
    pipe, software = _choose_pipe(base, params)
    properties = WindowProperties()
    properties.setSize(width, height)
    properties.setFullscreen(params.fullscreen)
    kind = "offscreen" if params.offscreen else "onscreen"
    opened = pipe is not None and base.openMainWindow(
        props=properties, pipe=pipe, type=kind, requireWindow=False
    )
    if not opened:
        base.destroy()
        raise UnavailableError(
            "no window could be opened",
            "Panda3D",
            "start it in a graphical session, or play a recording with --headless",
        )
    base.disableMouse()
    if not software:
        base.render.setAntialias(AntialiasAttrib.MAuto)
    return Stage(base, software)


def _choose_pipe(base: Any, params: StageParams) -> tuple[Any, bool]:
    """Who draws, and whether that is the processor; None: nobody can."""
    if params.renderer is not Renderer.SOFTWARE:
        module = "p3headlessgl" if params.offscreen else "pandagl"
        pipe = GraphicsPipeSelection.getGlobalPtr().makeModulePipe(module)
        if pipe is not None and pipe.isValid():
            by_processor = _draws_by_processor(base, pipe)
            if params.renderer is Renderer.GL or not by_processor:
                return pipe, by_processor
        if params.renderer is Renderer.GL:
            return None, False
    pipe = GraphicsPipeSelection.getGlobalPtr().makeModulePipe("p3tinydisplay")
    if params.offscreen or pipe is None or not pipe.isValid():
        pipe = _offscreen_software_pipe() if params.offscreen else None
    return pipe, True


def _offscreen_software_pipe() -> Any:
    selection = GraphicsPipeSelection.getGlobalPtr()
    selection.loadAuxModules()
    for kind in selection.getPipeTypes():
        if kind.getName() == "TinyOffscreenGraphicsPipe":
            return selection.makePipe(kind)
    return None


def _draws_by_processor(base: Any, pipe: Any) -> bool:
    """Whether an OpenGL is one of software: asked by a picture of 8 x 8."""
    probe = base.graphicsEngine.makeOutput(
        pipe,
        "probe",
        0,
        FrameBufferProperties.getDefault(),
        WindowProperties.size(8, 8),
        GraphicsPipe.BFRefuseWindow,
    )
    if probe is None:
        return True
    base.graphicsEngine.openWindows()
    gsg = probe.getGsg()
    name = gsg.getDriverRenderer().lower() if gsg is not None else "software"
    base.graphicsEngine.removeWindow(probe)
    return any(one in name for one in _BY_PROCESSOR)
