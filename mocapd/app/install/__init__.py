"""What systemd needs of us, put in place and taken away."""
