"""The task behind the environments of hands: bring the object to its pose."""
