"""Distances to all regions at once, on a coarser grid, are those that OpenCV measures one by one."""

import cv2
import numpy as np

from mocapd.tracking.cues.clothes.appearance import region_distances
from mocapd.tracking.cues.clothes.appearance_kernels import DISTANCE_GRID_PX
from mocapd.tracking.cues.clothes.regions import Region


def test_distances_are_those_of_a_distance_transform_of_each_region() -> None:
    drawn = np.zeros((90, 70), np.uint8)
    cv2.ellipse(drawn, (30, 40), (9, 25), 20.0, 0.0, 360.0, int(Region.TRUNK), -1)
    cv2.circle(drawn, (40, 12), 6, int(Region.FACE), -1)
    cv2.circle(drawn, (64, 85), 9, int(Region.FOOT), -1)
    distance_px, coarse = region_distances(drawn), drawn[::DISTANCE_GRID_PX, ::DISTANCE_GRID_PX]
    for region in Region:
        mine = distance_px[..., region - 1]
        if region in coarse:
            away = (coarse != region).astype(np.uint8)
            expected = cv2.distanceTransform(away, cv2.DIST_L2, cv2.DIST_MASK_3)
            np.testing.assert_allclose(mine, DISTANCE_GRID_PX * expected, atol=2e-2)
        else:
            assert mine.min() > 500.0
