"""`flatrig bench`, `accuracy`, `hands` and `lean`: speed, error, and what a scene carries."""
