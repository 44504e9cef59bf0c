"""From a rig and a path to the exact inputs: equations, structure, Taylor stages, branches."""
