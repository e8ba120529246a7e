"""Pictures of random people, on which the network of heatmaps is trained."""
