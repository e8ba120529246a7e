"""Any clothes: learned colours of body regions before a learned background."""
