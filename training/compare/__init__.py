"""`flatrig compare`: controllers side by side over the same disturbed scenarios."""
