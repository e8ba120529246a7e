"""The published tracker of Rao and Hodges measured as its authors did: on points of real motion, with its root given."""
