"""The step Body: stature and proportions."""
