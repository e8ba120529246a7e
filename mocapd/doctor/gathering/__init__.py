"""What is asked of the machine: facts, and no judgement on them."""
