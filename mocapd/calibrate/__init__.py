"""From cameras and a shirt to a calibration: lens, room, colours."""
