"""What the wearer looks like, as it was learned, and the fitter that tells no more regions apart than that."""

from mocapd.fit.motion_state import MotionState
from mocapd.fit.solver import Fitter
from mocapd.tracking.cues.clothes.camera_views import CameraViews
from mocapd.tracking.cues.clothes.clothes_params import ClothesParams
from mocapd.tracking.cues.clothes.look import ALL_DIFFER, Dressed, DressedFitters, Look, look_of


class Wardrobe:
    """The look of whoever is tracked; that of nobody at first."""

    def __init__(self, fitters: DressedFitters, params: ClothesParams) -> None:
        self._fitters, self._params = fitters, params
        self.dressed: Dressed = fitters.of(ALL_DIFFER)

    @property
    def fitter(self) -> Fitter:
        """Of the present look."""
        return self.dressed.fitter

    def forget(self, cameras: CameraViews) -> None:
        """Nobody's look is known."""
        self._dress(ALL_DIFFER, cameras)

    def learn_first(self, state: MotionState, cameras: CameraViews) -> None:
        """Learn the look of somebody who was found."""
        self._dress(ALL_DIFFER, cameras)
        cameras.learn_first_appearance(state)
        seen = [cameras.each[i].appearance for i in cameras.present]
        look = look_of(seen, self._params.alike)
        for camera in cameras.each:
            camera.appearance.join(look)
        self._dress(look, cameras)

    def _dress(self, look: Look, cameras: CameraViews) -> None:
        self.dressed = self._fitters.of(look)
        cameras.fitter = self.dressed.fitter
