"""`mocapd doctor`: finds obstacles to tracking on this machine, with the command that fixes each."""
