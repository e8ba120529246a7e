"""Body trackers for SteamVR by the driver VMT (Virtual Motion Tracker), as OSC over UDP."""
