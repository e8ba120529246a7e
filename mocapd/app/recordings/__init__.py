"""Records a daemon's stream, replays and exports recordings."""
