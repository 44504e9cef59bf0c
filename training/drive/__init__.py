"""`flatrig drive`: a crane that is driven by hand, live in a page of a browser."""
