"""What the studies measure; the commands are beside this folder."""
