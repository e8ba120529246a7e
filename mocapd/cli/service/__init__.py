"""Commands around mocapd as a service of systemd."""
