"""Cylinders of the limbs against pictures, and particles of one limb [Hecht et al. 2009, section III]."""
