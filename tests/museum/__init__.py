"""Files as each version of mocapd wrote them: they are read for as long as there is a mocapd."""
