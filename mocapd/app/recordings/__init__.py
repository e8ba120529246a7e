"""Recording what a daemon publishes, playing it again, exporting it."""
