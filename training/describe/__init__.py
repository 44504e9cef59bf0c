"""`flatrig list`, `analyse`, `solve` and `render`: what a rig is and what its move takes."""
