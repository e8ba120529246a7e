"""Every parser and its fuzzer: the table of the attack of 2026-11-22, and what was found beside it."""

from tests.fuzz import calibrations, configs, drawings, recordings, setups, wires
from tests.fuzz.row import Row

ROWS = (
    Row("rig", 6023, calibrations.rigs),
    Row("calibration", 5057, calibrations.calibrations),
    Row("calibration-pictures", 6000, calibrations.pictures),
    Row("lenses", 6028, calibrations.lenses),
    Row("config", 6029, configs.files),
    Row("flags", 2552, configs.flags),
    Row("capture", 2200, recordings.captures),
    Row("live-pace", 28, recordings.live_paces),
    Row("scenario", 4029, configs.scenarios),
    Row("camera-string", 16032, configs.cameras),
    Row("destination-string", 8032, configs.destinations),
    Row("endpoint-string", 8032, configs.endpoints),
    Row("board-size", 2000, configs.boards),
    Row("strokes-upload", 5052, drawings.uploads),
    Row("labelled-images", 6298, drawings.labelled_images),
    Row("webcam-frames", 5042, recordings.webcam_frames),
    Row("videos", 9000, recordings.videos),
    Row("wire", 8881, wires.frames),
    Row("setup-values", setups.number_of_values(), setups.values),
    Row("setup-sequences", 3898, setups.sequences),
    Row("setup-strokes", 400, setups.solved_strokes),
    Row("password-file", 3000, wires.users),
)
