"""What is known before the first frame: the record, and the file it is kept in."""
