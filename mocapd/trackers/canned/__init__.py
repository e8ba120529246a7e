"""The tutorial tracker: a looping pose, whatever the cameras show."""
