"""Drops the parts of a draft that a change of cameras makes invalid."""

from dataclasses import replace

from mocapd.wizard.draft import Draft, DraftCamera


def with_cameras(draft: Draft, cameras: tuple[DraftCamera, ...]) -> Draft:
    """The draft with these cameras, without the data of others: the lens of a camera with another size, colours of
    one that left or has other controls, the room of another set of cameras."""
    if cameras == draft.cameras:
        return draft
    before = {camera.id: camera for camera in draft.cameras}
    # without cameras before, the data come from the saved calibration of just these
    same_size = {
        camera.id for camera in cameras if before.get(camera.id, camera).size_px == camera.size_px
    }
    same_look = {
        camera.id
        for camera in cameras
        if camera.id in same_size and before.get(camera.id, camera).controls == camera.controls
    }
    lenses = {name: lens for name, lens in draft.intrinsics.items() if name in same_size}
    colours = {name: colours for name, colours in draft.colours.items() if name in same_look}
    draft = replace(
        draft,
        cameras=cameras,
        intrinsics=lenses,
        intrinsics_saved=draft.intrinsics_saved & lenses.keys(),
        colours=colours,
    )
    names = {camera.id for camera in cameras}
    if draft.rig is not None and (set(draft.rig.names) != names or len(same_size) < len(cameras)):
        draft = replace(draft, rig=None, extrinsics_quality=None, floor_known=False)
    return draft
