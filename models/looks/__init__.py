"""What rigs and hands look like in MuJoCo, made only where somebody looks."""
