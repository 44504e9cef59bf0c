"""The task behind the environments of cranes: follow a reference path."""
