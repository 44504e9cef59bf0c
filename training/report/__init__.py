"""`flatrig report`: one page about a crane and its move, for a colleague."""
