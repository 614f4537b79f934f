"""What the results are measured on, and the commands that measure them."""
