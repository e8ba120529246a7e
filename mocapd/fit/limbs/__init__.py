"""Arms and legs that do not agree with the pictures: other poses of them are tried, the best is kept."""
