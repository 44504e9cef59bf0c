"""What solves for a rig's motion: by its own program, and where that has no answer step by step."""
