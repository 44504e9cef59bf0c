"""From a description to its MuJoCo model, nothing drawn; and between the two's coordinates."""
