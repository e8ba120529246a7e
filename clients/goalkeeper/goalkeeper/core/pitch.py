"""Goal and field, in the goal's frame: the keeper stands at the origin and faces +Z, +X is his left, +Y up [m]."""

TICK_HZ = 120
TICK_S = 1.0 / TICK_HZ

GOAL_WIDTH_M = 3.0  # futsal and handball: one that a person with two steps of room can keep
GOAL_HEIGHT_M = 2.0
GOAL_LINE_Z_M = -0.45
GOAL_DEPTH_M = 1.0
POST_RADIUS_M = 0.04
SHOT_FROM_Z_M = (8.5, 11.0)
SHOT_FROM_X_M = 3.0  # to either side
