"""The shirt in pictures: its colours, its segmentation, and the pose database."""
