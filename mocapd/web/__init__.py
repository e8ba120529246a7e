"""The page on 127.0.0.1: the setup wizard and the live view, served by the process that has the cameras."""
