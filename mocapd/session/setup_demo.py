"""A first setup without cameras: simulated webcams, a simulated board and a simulated wearer."""

from dataclasses import dataclass
from pathlib import Path

from mocapd.assets import asset_path
from mocapd.capture.origin import camera_address
from mocapd.capture.simulated.sim_kind import scenario_address
from mocapd.capture.simulated.stage import SceneSource, Stage
from mocapd.clock import monotonic_ns
from mocapd.session.tracker_setup import Progress
from mocapd.sim.board.board_clips import load_board_clips
from mocapd.sim.board.board_picture import PrintedBoard
from mocapd.sim.clips import wearer_clips
from mocapd.sim.film import load_film
from mocapd.sim.scenario import load_scenario
from mocapd.sim.setup_scenes import SETUP_BOARD
from mocapd.types import Rig

SCENARIO = "first_setup"


@dataclass(frozen=True, slots=True, eq=False)
class Demo:
    """Cameras (id, source) that film one stage; `stage.play(scene)` chooses the scene.

    source_of(id): the camera's address for a configuration. board: the board in the scenes; rig: ground truth of the
    calibration.
    """

    cameras: tuple[tuple[str, SceneSource], ...]
    stage: Stage
    board: PrintedBoard
    stature_m: float
    rig: Rig

    @staticmethod
    def source_of(camera: str) -> str:
        """`sim:...`: the same camera, with the wearer's motion in a loop."""
        return camera_address(scenario_address(SCENARIO), camera)

    @property
    def fps_hz(self) -> float:
        """The rate of all cameras."""
        return self.stage.scenario.fps_hz


def open_demo(cache_dir: Path, progress: Progress) -> Demo:
    """Opens the demo; renders its pictures unless they are cached. Raises MocapdError."""
    scenario = load_scenario(asset_path(f"scenarios/{SCENARIO}.toml"))
    film = load_film(
        scenario, cache_dir, lambda done, total: progress("rendering the wearer", done, total)
    )
    boards = load_board_clips(
        scenario, cache_dir, lambda done, total: progress("rendering the board", done, total)
    )
    stage = Stage(scenario, boards | wearer_clips(film), monotonic_ns())
    return Demo(
        cameras=tuple((spec.name, SceneSource(stage, spec.name)) for spec in scenario.cameras),
        stage=stage,
        board=SETUP_BOARD,
        stature_m=scenario.body.stature_m,
        rig=film.setup.rig,
    )
