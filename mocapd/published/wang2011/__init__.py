"""The method with the shirt as published (Wang et al. 2011), with its constants, for comparison."""
