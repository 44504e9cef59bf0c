"""Scripts that tests run in processes of their own, and items that take their process down."""

import os
import subprocess
import sys
from pathlib import Path

# Functions that a process finds wherever it runs: items are Python.
SUICIDE = "__import__('os').kill(__import__('os').getpid(), 9)"


def once(marker: Path) -> str:
    """Python that takes its process down the first time, and is True the second."""
    first = f"__import__('os').mkdir({str(marker)!r}) or {SUICIDE}"
    return f"__import__('os').path.exists({str(marker)!r}) or {first}"


def told_by(script: str, folder: Path, *words: str) -> list[str]:
    """What a script prints."""
    (folder / "script.py").write_text(script)
    environment = {name: os.environ[name] for name in os.environ if name != "RAY_ADDRESS"}
    done = subprocess.run(
        [sys.executable, "script.py", *words], cwd=folder, capture_output=True, text=True,
        check=False, timeout=240, env=environment,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return done.stdout.splitlines()
