"""Taylor series in time, of products and of rotations."""
