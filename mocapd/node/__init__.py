"""A camera node: sends the pictures of a small computer's webcams to a daemon on another machine."""
