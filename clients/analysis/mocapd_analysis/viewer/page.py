"""The viewer's page: scene and controls on viser, for sessions that are recorded or still come."""

import time
from collections.abc import Callable, Sequence

import numpy as np
import viser
import viser.uplot

from mocapd_analysis.measures import Measures
from mocapd_analysis.viewer.moment import Moment
from mocapd_analysis.viewer.person import TRAILS, Person
from mocapd_analysis.viewer.playback import RATES, Playback, rate_of
from mocapd_analysis.viewer.readings import reading, speed_window, summary

COLOURS = ((40, 78, 104), (150, 78, 38))
FRAMES_HZ = 30.0
_READINGS_S = 0.12
# Where one looks from, of the person's middle [m].
_VIEWS = {
    "Front": (0.0, 0.4, 3.6),
    "Left": (3.6, 0.4, 0.0),
    "Right": (-3.6, 0.4, 0.0),
    "Back": (0.0, 0.4, -3.6),
    "Above": (0.0, 3.8, 0.05),
}
_BEGINNING, _BEST_SWING = "the beginning", "the fastest swing"


class ViewerPage:
    """One server on 127.0.0.1; `tick` moves everything on. Callbacks of viser only change `playback` and fields here."""

    def __init__(self, port: int, title: str) -> None:
        self.server = viser.ViserServer(host="127.0.0.1", port=port, label=title, verbose=False)
        self.playback = Playback(0.0, 0.0, 0.0)
        self._people: list[Person] = []
        self._shown: tuple[tuple[str, ...], ...] = ()
        self._sessions: tuple[Measures, ...] = ()
        self._next_readings_s = 0.0
        self._scene()
        self._controls()

    @property
    def url(self) -> str:
        """Where a browser finds it."""
        return f"http://127.0.0.1:{self.server.get_port()}"

    def stop(self) -> None:
        """Close the server."""
        self.server.stop()

    def _scene(self) -> None:
        scene = self.server.scene
        scene.set_up_direction("+y")
        scene.add_grid(
            "/floor", 12.0, 12.0, plane="xz", cell_size=0.5, plane_color=(238, 238, 234), plane_opacity=1.0,
            cell_color=(206, 206, 200), section_color=(176, 176, 170),
        )  # fmt: skip
        self.server.initial_camera.position = (1.9, 1.7, 3.2)
        self.server.initial_camera.look_at = (0.0, 0.95, 0.0)
        self.server.gui.configure_theme(control_width="large", dark_mode=False)

    def _controls(self) -> None:
        gui = self.server.gui
        self._status = gui.add_markdown("")
        with gui.add_folder("Time"):
            self._play = gui.add_button("Pause")
            self._time = gui.add_slider("Time [s]", 0.0, 1.0, 0.001, 0.0)
            self._rate = gui.add_dropdown("Speed", RATES, initial_value="1")
            self._steps = gui.add_button_group("Frame", ("back", "on"))
            self._to_swing = gui.add_button("To the fastest swing")
            self._loop = gui.add_checkbox("Again and again", initial_value=True)
        with gui.add_folder("View"):
            self._views = gui.add_button_group("From", tuple(_VIEWS))
            self._trail_s = gui.add_slider("Trail [s]", 0.0, 5.0, 0.1, 1.0)
            self._apart_m = gui.add_slider("Apart [m]", 0.0, 4.0, 0.1, 1.6)
            self._align = gui.add_dropdown("Together at", (_BEGINNING, _BEST_SWING))
        self._words: list[viser.GuiMarkdownHandle] = []
        self._summaries: list[viser.GuiMarkdownHandle] = []
        self._plots: list[viser.GuiUplotHandle] = []
        self._play.on_click(lambda _: self._toggle())
        self._time.on_update(self._slid)
        self._rate.on_update(lambda _: setattr(self.playback, "rate", rate_of(self._rate.value)))
        self._steps.on_click(lambda _: self._step(1 if self._steps.value == "on" else -1))
        self._to_swing.on_click(lambda _: self._seek_swing())
        self._loop.on_update(lambda _: setattr(self.playback, "loop", self._loop.value))
        self._views.on_click(self._look)
        self._align.on_update(lambda _: self._fit())

    def _toggle(self) -> None:
        playback = self.playback
        if not playback.playing and playback.at_s >= playback.end_s:
            playback.seek(playback.start_s)
        playback.playing = not playback.playing

    def _slid(self, event: viser.GuiEvent[viser.GuiSliderHandle[float]]) -> None:
        if event.client is not None:  # and not by ourselves
            self.playback.seek(float(self._time.value) + self.playback.start_s)

    def _step(self, frames: int) -> None:
        if self._sessions:
            self.playback.step(self._sessions[0].session, frames)

    def _seek_swing(self) -> None:
        swing = self._sessions[0].best_swing if self._sessions else None
        if swing is not None:
            self.playback.seek(swing.at_s - 0.4)

    def _look(self, event: viser.GuiEvent[viser.GuiButtonGroupHandle]) -> None:
        if event.client is not None:
            middle = np.array([0.0, 1.0, 0.0])
            event.client.camera.position = middle + _VIEWS[self._views.value]
            event.client.camera.look_at = middle

    def _shifts_s(self) -> list[float]:
        """What each session's own time is ahead of the time shown."""
        swings = [found.best_swing for found in self._sessions]
        if self._align.value != _BEST_SWING or any(swing is None for swing in swings):
            return [0.0] * len(swings)
        first = swings[0].at_s if swings[0] else 0.0
        return [swing.at_s - first if swing else 0.0 for swing in swings]

    def _fit(self) -> None:
        """The time that is shown holds every session."""
        shifts_s = self._shifts_s()
        ends = [
            (float(found.session.times_s[0]) - shift_s, float(found.session.times_s[-1]) - shift_s)
            for found, shift_s in zip(self._sessions, shifts_s, strict=True)
        ]
        self.playback.start_s = min(start_s for start_s, _ in ends)
        self.playback.end_s = max(end_s for _, end_s in ends)
        self.playback.seek(self.playback.at_s)
        self._time.max = max(round(self.playback.end_s - self.playback.start_s, 3), 0.001)

    def tick(self, moment: Moment, passed_s: float) -> None:
        """Show the next picture: `passed_s` after the last one."""
        if moment.sessions:
            self._take(moment)
            if moment.is_live and self.playback.playing and self.playback.rate >= 1.0:
                self.playback.at_s = self.playback.end_s
            else:
                self.playback.advance(passed_s)
        shifts_s = self._shifts_s()
        middle = 0.5 * (len(self._sessions) - 1)
        for number, (person, found) in enumerate(zip(self._people, self._sessions, strict=True)):
            apart_m = (number - middle) * float(self._apart_m.value)
            at_s = self.playback.at_s + shifts_s[number]
            person.show(found.session, at_s, float(self._trail_s.value), apart_m)
        self._next_readings_s -= passed_s
        if self._next_readings_s <= 0.0:
            self._next_readings_s = _READINGS_S
            self._tell(moment, shifts_s)

    def _take(self, moment: Moment) -> None:
        """Other sessions than before, or a live one that went on."""
        if moment.sessions is self._sessions:
            return
        skeletons = tuple(found.session.joint_names for found in moment.sessions)
        self._sessions = moment.sessions
        if skeletons != self._shown:
            self._shown = skeletons
            for person in self._people:
                person.remove()
            self._people = [
                Person(self.server, f"/person{number}", found.session, COLOURS[number % 2])
                for number, found in enumerate(moment.sessions)
            ]
            self._panels()
        self._fit()
        for words, found in zip(self._summaries, moment.sessions, strict=True):
            words.content = summary(found)

    def _panels(self) -> None:
        for handle in (*self._words, *self._summaries, *self._plots):
            handle.remove()
        self._words, self._summaries, self._plots = [], [], []
        for number, found in enumerate(self._sessions):
            letter = f"{'AB'[number % 2]}: " if len(self._sessions) > 1 else ""
            with self.server.gui.add_folder(letter + found.session.name):
                self._summaries.append(self.server.gui.add_markdown(summary(found)))
                self._words.append(self.server.gui.add_markdown(""))
                self._plots.append(self._plot(found))

    def _plot(self, found: Measures) -> viser.GuiUplotHandle:
        left, right = (f"#{bytes(TRAILS[side]).hex()}" for side in ("left", "right"))
        return self.server.gui.add_uplot(
            speed_window(found, 0.0),
            (
                viser.uplot.Series(label="s"),
                viser.uplot.Series(label="left wrist m/s", stroke=left, width=2),
                viser.uplot.Series(label="right wrist m/s", stroke=right, width=2),
                viser.uplot.Series(label="now", stroke="#999999", width=1),
            ),
            scales={"x": viser.uplot.Scale(time=False)},
            aspect=2.2,
        )

    def _tell(self, moment: Moment, shifts_s: Sequence[float]) -> None:
        playback = self.playback
        self._status.content = moment.status
        self._play.label = "Pause" if playback.playing else "Play"
        self._time.value = round(min(playback.at_s - playback.start_s, float(self._time.max)), 3)
        panels = zip(self._sessions, shifts_s, self._words, self._plots, strict=True)
        for found, shift_s, words, plot in panels:
            words.content = reading(found, playback.at_s + shift_s)
            plot.data = speed_window(found, playback.at_s + shift_s)


def run(page: ViewerPage, newest: Callable[[], Moment], is_over: Callable[[], bool]) -> None:
    """Show what comes until it is over; on one thread."""
    last_s = time.monotonic()
    while not is_over():
        now_s = time.monotonic()
        page.tick(newest(), now_s - last_s)
        last_s = now_s
        time.sleep(max(0.0, 1.0 / FRAMES_HZ - (time.monotonic() - now_s)))
