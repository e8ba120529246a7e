"""The WebSockets of the page, one file each."""
