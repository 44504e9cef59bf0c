"""What is done with rigs, inputs and environments: the command `flatrig`, a room for each command.

`cli` is the command, `options` registers what it can do; `jobs`, `tables` and `plots` serve them
all, `simulate` holds runs in MuJoCo that several need, and `policy` runs a trained policy in plain
NumPy.  Importing this package loads none of them.
"""
