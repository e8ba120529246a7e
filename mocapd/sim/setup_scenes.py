"""The scenes of a first setup: what is before the simulated cameras while a step is done."""

from enum import StrEnum

from mocapd.sim.board.board_picture import PrintedBoard


class SetupScene(StrEnum):
    """Named as the steps of the setup name them."""

    EMPTY = "empty"  # no person in the room
    LENS = "lens"  # the board is shown to every camera, at many places and slants
    ROOM = "room"  # the board is held where the cameras see it together
    FLOOR = "floor"  # the board lies on the floor
    T_POSE = "t_pose"  # the wearer stands still, arms out
    ARM_BENDS = "arm_bends"  # T-pose, and the elbows bend
    MOVING = "moving"  # walks about and moves the arms


# When the scenario's motion shows the wearer's scenes [s]
WEARER_S = {
    SetupScene.T_POSE: (0.0, 1.5),
    SetupScene.ARM_BENDS: (1.5, 5.5),
    SetupScene.MOVING: (5.5, 15.5),
}

# The default board's squares and markers on a sheet of A1: on the floor of the play area, seen at a
# slant by cameras of 640x480, the cells of smaller markers are under two pixels.
SETUP_BOARD = PrintedBoard(5, 7, 0.11, 0.0825, "DICT_4X4_1000")
