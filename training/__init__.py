"""Residual policies, the comparison of controllers, and the command line.

`policy` runs a trained policy in plain NumPy, `compare` sets controllers side by side, `train`
trains with stable-baselines3, `bench` measures, `cli` is the command `flatrig`.
Importing this package loads none of them.
"""
