"""What the webcams of `vm_test.sh` show, and the calibration that goes with it: the demo's living room as two films that
go round, and a state directory in which its cameras are webcams by their sockets and serial numbers.

    python vm_home.py FOLDER        makes FOLDER/cam0.mp4, cam1.mp4 and FOLDER/state
"""

import sys
from datetime import UTC, datetime
from pathlib import Path

from lab.simulated.export import export_capture
from mocapd import __version__
from mocapd.assets import asset_path
from mocapd.calibration.calibration_file import FILE_NAME
from mocapd.calibration.calibration_writing import write_calibration
from mocapd.calibration.saved_calibration import (
    SCHEMA,
    ColourFit,
    Made,
    RoomFit,
    SavedCalibration,
    SavedCamera,
    SavedWearer,
)
from mocapd.capture.capture_folder import load_folder
from mocapd.capture.kinds.folder_kind import FolderOrigin
from mocapd.geometry.rig_file import load_rig
from mocapd.shirt.colour.from_pictures import colour_model, white_balances
from mocapd.sim.scenario import load_scenario
from mocapd.wizard.saving import NOT_WRITTEN_YET

SOURCES = {"cam0": "usb:1-1:046d:0825:CAM0000", "cam1": "usb:1-2:046d:0825:CAM0001"}
IDS = {"cam0": "left", "cam1": "right"}


def make_home(folder: Path) -> None:
    """Films of one loop, and the calibration."""
    scenario = load_scenario(asset_path("scenarios/living_room.toml"))
    export_capture(scenario, folder, scenario.loop_s)
    origin = FolderOrigin(load_folder(folder))
    pictures = {IDS[name]: one for name, one in origin.white_balance().items()}
    W = white_balances(pictures, colour_model(origin.model()))
    saved = SavedCalibration(
        schema=SCHEMA,
        made=Made(when=datetime.now(UTC).replace(microsecond=0), by="vm", mocapd=__version__),
        room=RoomFit(method="board"),
        wearer=SavedWearer(stature_m=scenario.body.stature_m, personal_colours=True),
        camera=tuple(
            SavedCamera(
                id=IDS[one.name],
                source=SOURCES[one.name],
                size_px=one.size_px,
                K=one.K.tolist(),
                dist=one.dist.tolist(),
                R=one.R.tolist(),
                t_m=one.t_m.tolist(),
                colour=ColourFit(
                    picture=NOT_WRITTEN_YET,
                    strokes=NOT_WRITTEN_YET,
                    W=W[IDS[one.name]].tolist(),
                ),
            )
            for one in load_rig(folder / "rig.json").cameras
        ),
    )
    write_calibration(folder / "state" / FILE_NAME, saved, pictures)


if __name__ == "__main__":
    make_home(Path(sys.argv[1]))
