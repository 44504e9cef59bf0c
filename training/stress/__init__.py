"""`flatrig stress`: stiff and extreme cases, each of which must end as it is told to."""
