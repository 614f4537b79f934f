"""Search for similar patches and poses."""
