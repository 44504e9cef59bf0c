"""Andrews' squeezing mechanism: its data and its MuJoCo scene."""
