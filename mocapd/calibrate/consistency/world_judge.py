"""Checks whether people stand upright on the floor of a rig's world, and have a person's size."""

from collections.abc import Iterator, Sequence

import numpy as np

from mocapd.calibrate.consistency.findings import CaptureFinding, Mistake
from mocapd.calibrate.consistency.person_views import PersonView
from mocapd.calibrate.consistency.view_agreement import PairFit
from mocapd.geometry.camera_model import normalised
from mocapd.types import Camera, Floats
from mocapd.vision.heatmaps.joint_network import BODY_JOINTS, STATURE_M

_HIPS, _NECK = BODY_JOINTS.index("hips"), BODY_JOINTS.index("neck")
_UPRIGHT_DEG = 45.0  # people bend; not all the time
_TURNED_DEG = 60.0
_LEAST_ANGLES = 8  # of a view
_OFTEN = 0.75  # of views
_SIZES = (0.62, 1.5)  # of people against their stature, as the network's joints measure them
_FLOOR_M = (-0.3, 0.5)  # where feet are, on the floor y = 0
_AGREES = 1.3  # cost of views from which the world is judged
_LEAST = 2  # such views
_PARALLAX_DEG = 10.0  # between rays, to measure sizes by them
_KNOWN_FACTORS = {
    "feet": 1 / 0.3048,
    "inches": 1 / 0.0254,
    "centimetres": 100.0,
    "millimetres": 1000.0,
}
_NEAR = 1.25  # a factor this near to a unit's is that unit
_COLUMNS = {  # of R, by the up axis of the given world: y up is wanted
    "+z": "(r_x, r_z, -r_y)",
    "-z": "(r_x, -r_z, r_y)",
    "-y": "(r_x, -r_y, -r_z)",
    "+x": "(-r_y, r_x, r_z)",
    "-x": "(r_y, -r_x, r_z)",
}


def judge_world(
    names: tuple[str, ...], fits: Sequence[PairFit], stature_m: float | None
) -> CaptureFinding | None:
    """An implausible property of the people in views that agree."""
    wide = [
        fit
        for fit in fits
        if fit.parallax_deg > _PARALLAX_DEG and np.isfinite(fit.size) and fit.cost < _AGREES
    ]
    if len(wide) < _LEAST:
        return None
    up = np.sum([fit.count * fit.up for fit in wide], axis=0)
    up /= max(float(np.linalg.norm(up)), 1e-9)
    if up[1] < np.cos(np.radians(_UPRIGHT_DEG)):
        return _tilt_finding(names, up)
    size = float(np.median([fit.size for fit in wide])) * STATURE_M / (stature_m or STATURE_M)
    if not _SIZES[0] < size < _SIZES[1]:
        return _size_finding(names, size, stature_m)
    floors = [fit.floor_m for fit in wide if np.isfinite(fit.floor_m)]
    if len(floors) > 1 and not _FLOOR_M[0] < float(np.median(floors)) < _FLOOR_M[1]:
        return CaptureFinding(
            Mistake.AXES,
            names,
            f"feet are {float(np.median(floors)):+.1f} m from the rig's floor",
            "the floor is where y = 0: move the rig's origin there, or calibrate the room again",
        )
    return None


def _tilt_finding(names: tuple[str, ...], up: Floats) -> CaptureFinding:
    k = int(np.abs(up).argmax())
    axis = ("+" if up[k] > 0 else "-") + "xyz"[k]
    if abs(up[k]) > 0.8 and axis in _COLUMNS:
        return CaptureFinding(
            Mistake.AXES,
            names,
            f"people stand along the {axis} axis of the rig's world",
            f"mocapd takes +y up: write the columns of each R as {_COLUMNS[axis]}",
        )
    lean_deg = float(np.degrees(np.arccos(np.clip(up[1], -1.0, 1.0))))
    return CaptureFinding(
        Mistake.AXES,
        names,
        f"people lean by {lean_deg:.0f} degrees in the rig's world",
        "mocapd takes +y up, with the floor at y = 0: turn the rig's world, or calibrate the room again",
    )


def _size_finding(names: tuple[str, ...], size: float, stature_m: float | None) -> CaptureFinding:
    unit = min(_KNOWN_FACTORS, key=lambda name: abs(np.log(size / _KNOWN_FACTORS[name])))
    tall = f"people are about {size * (stature_m or STATURE_M):.2g} m tall in the rig's world"
    if abs(np.log(size / _KNOWN_FACTORS[unit])) < np.log(_NEAR):
        return CaptureFinding(
            Mistake.UNIT,
            names,
            f"{tall}: 't' looks like {unit}",
            f"'t' is in metres: multiply it by {1.0 / _KNOWN_FACTORS[unit]:.4g}",
        )
    return CaptureFinding(
        Mistake.UNIT,
        names,
        tall,
        f"'t' is in metres: is its unit another one, or were all pictures cut or zoomed? 't' times {1 / size:.2g} would fit",
    )


def turned_views(
    cameras: Sequence[Camera], people: Sequence[Sequence[PersonView]]
) -> Iterator[CaptureFinding]:
    """Cameras in whose pictures people do not stand along the rig's vertical; people: of each camera."""
    for camera, views in zip(cameras, people, strict=True):
        turns_deg = [
            _median_deg(angles)
            for view in views
            if len(angles := _lean_deg(camera, view)) >= _LEAST_ANGLES
        ]
        turned = [turn_deg for turn_deg in turns_deg if abs(turn_deg) > _TURNED_DEG]
        # a person who bends down is no rotated picture: at other times the same picture is upright
        if len(turned) < _LEAST or len(turned) < _OFTEN * len(turns_deg):
            continue
        turn_deg = _median_deg(turned)
        quarters = round(turn_deg / 90.0) * 90
        yield CaptureFinding(
            Mistake.TURNED,
            (camera.name,),
            f"people in the pictures of {camera.name!r} are turned by {quarters} degrees against the rig's vertical",
            "turn the video back, or calibrate it so; if all are turned: is +y up in rig.json, and R world-to-camera?",
        )


def _median_deg(angles_deg: Sequence[float]) -> float:
    radians = np.radians(angles_deg)
    return float(np.degrees(np.arctan2(np.median(np.sin(radians)), np.median(np.cos(radians)))))


def _lean_deg(camera: Camera, view: PersonView) -> list[float]:
    """For each picture, the angle from the projected vertical of the world to the trunk."""
    sure = (view.spread[:, _HIPS] < 2.0) & (view.spread[:, _NECK] < 2.0)
    hips, neck = view.px[sure, _HIPS], view.px[sure, _NECK]
    xy = normalised(camera, hips)
    up = camera.R[:, 1]
    # the image direction of a point that moves up, at any distance
    way = up[:2] - xy * up[2]
    trunk = neck - hips
    long = np.linalg.norm(way, axis=1) > 0.3
    angle = np.arctan2(trunk[:, 1], trunk[:, 0]) - np.arctan2(way[:, 1], way[:, 0])
    wrapped = (np.degrees(angle) + 180.0) % 360.0 - 180.0
    return [float(angle_deg) for angle_deg in wrapped[long]]
