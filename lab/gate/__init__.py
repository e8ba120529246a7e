"""The gate: what a change of the tracking does to its figures, on every set of recordings that we have."""
