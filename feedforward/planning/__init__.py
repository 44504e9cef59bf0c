"""Which moves a rig can make: checks, durations, obstacles, and the height of a free pulley."""
