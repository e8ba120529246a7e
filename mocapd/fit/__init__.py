"""The articulated least-squares solver and its terms, and the limb search that rescues it."""
