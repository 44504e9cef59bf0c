"""Driving a rig by the velocity of its load, tick by tick."""
