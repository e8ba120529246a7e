"""A small computer with webcams: their pictures to a daemon on another machine."""
