"""What the steps that need a board share: looking for it, its form, advice, sightings."""
