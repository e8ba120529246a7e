"""The capture thread of one camera: state and counters, detection of bad pictures, reopening of a lost camera."""
