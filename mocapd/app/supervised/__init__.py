"""What the service manager that started the daemon is told."""
