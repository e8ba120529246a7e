"""The articulated least-squares solver and its terms, and the search for limb hypotheses."""
