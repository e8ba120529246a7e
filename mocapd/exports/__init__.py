"""Files of motion for other programs, one format a folder: what is written is read back by another library in the tests."""
