"""The learned appearance of the wearer, and the solvers for the regions that it distinguishes."""

from mocapd.fit.motion_state import MotionState
from mocapd.fit.solver import Fitter
from mocapd.tracking.cues.clothes.camera_views import CameraViews
from mocapd.tracking.cues.clothes.clothes_params import ClothesParams
from mocapd.tracking.cues.clothes.region_merge import (
    NO_MERGE,
    RegionMerge,
    RegionSolverCache,
    RegionSolvers,
    choose_merge,
)


class WearerAppearance:
    """The region merge and solvers of the tracked person; initially no regions are merged."""

    def __init__(self, fitters: RegionSolverCache, params: ClothesParams) -> None:
        self._fitters, self._params = fitters, params
        self.merge: RegionMerge = NO_MERGE
        self.solvers: RegionSolvers = fitters.of(NO_MERGE)

    @property
    def fitter(self) -> Fitter:
        """The fitter of the present region merge."""
        return self.solvers.fitter

    def forget(self, cameras: CameraViews) -> None:
        """Back to unmerged regions."""
        self._set_merge(NO_MERGE, cameras)

    def learn_first(self, state: MotionState, cameras: CameraViews) -> None:
        """Learns the appearance of a newly found person."""
        self._set_merge(NO_MERGE, cameras)
        cameras.learn_first_appearance(state)
        # a camera that does not show the person says nothing
        appearances = [
            one for i in cameras.present if (one := cameras.each[i].appearance).is_learned
        ]
        merge = choose_merge(appearances, self._params.alike) if appearances else NO_MERGE
        for camera in cameras.each:
            camera.appearance.merge_regions(merge)
        self._set_merge(merge, cameras)

    def _set_merge(self, merge: RegionMerge, cameras: CameraViews) -> None:
        self.merge, self.solvers = merge, self._fitters.of(merge)
        cameras.fitter = self.solvers.fitter
