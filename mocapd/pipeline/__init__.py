"""Between cameras and outputs: mailboxes, the bundler, smoothing, the loop, metrics."""
