"""Search for similar patches of motions."""
