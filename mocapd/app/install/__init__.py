"""Installs and removes the files of the systemd service."""
