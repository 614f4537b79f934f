"""Search for similar patches of motions."""
"""Search for similar poses."""
