"""Runs in MuJoCo that several commands share: open loop, closed loop, free, and of hands."""
