"""What a body is seen by, one folder each."""
