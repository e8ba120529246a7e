"""Where the keeper's poses come from: a daemon, a recording, a simulated person."""
