"""Body trackers for VRChat, as OSC over UDP."""
