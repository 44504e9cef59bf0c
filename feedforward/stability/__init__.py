"""Kiss's proof of stability as numbers: the energy W, its regulator, and rivals."""
