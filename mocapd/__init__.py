"""mocapd: a headless service that turns ordinary webcams into body-pose input for games and VR."""

__version__ = "0.1.0"
