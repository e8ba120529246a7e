"""The shirt: its patches place trunk and arms, and find the wearer from nothing."""
