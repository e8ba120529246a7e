"""What is trained, and the pictures of random people on which the network of heatmaps is."""
