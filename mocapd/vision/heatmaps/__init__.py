"""A convolutional network that tells where in a picture each joint of a person is."""
