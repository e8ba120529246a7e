"""The compiled kernels as a whole: which there are, what their compiling costs, and when a kept one is still good."""
