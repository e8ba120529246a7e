"""What the wearer looks like to each camera: the colours of regions, and which regions look alike."""
