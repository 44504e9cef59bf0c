"""Straight-line programs for the inverse dynamics of one rig, in Python, NumPy and C99."""
