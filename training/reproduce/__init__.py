"""`flatrig reproduce`: the sources' figures and claims, computed anew."""
