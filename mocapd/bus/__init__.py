"""Common code of Zenoh sessions: client configuration, limits, safe calls at the end of the process."""
