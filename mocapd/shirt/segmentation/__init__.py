"""Which pixels show which colour of the shirt, given a pose or from nothing."""
