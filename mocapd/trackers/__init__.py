"""From frame sets to bodies. Every tracker is a pure step machine behind `base.Tracker`."""
