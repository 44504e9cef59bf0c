"""What a rolling-contact hand is: fingers and the object they hold, moves, and the catalogue."""
