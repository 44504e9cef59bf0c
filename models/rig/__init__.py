"""What a rig is: frames, rails, masses and ropes, its moves, TOML files, and the catalogue."""
