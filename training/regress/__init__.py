"""`flatrig regress`: every model and integrator against stored numbers."""
