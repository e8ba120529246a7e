"""TRC: OpenSim, Pose2Sim."""
