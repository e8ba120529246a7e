"""What systemd needs of mocapd: units, user, device rule, put in place and taken away."""
