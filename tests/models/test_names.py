"""Names become files, columns and parts of models: they are plain words."""

import json
from dataclasses import replace

import pytest

from flatrig import models
from flatrig.models import Load

RIG = models.overhead_crane()

BAD = (
    "../../x",
    "/etc/passwd",
    "two\nlines",
    "",
    " ",
    "a b",
    "a.b",
    "a/b",
    "x" * 65,
    "a\0",
    "\x1b[31m",
)


@pytest.mark.parametrize("name", BAD)
def test_names_that_no_file_should_have(name):
    hand = models.make_hand("two-finger-hand")
    for build in (
        lambda: replace(RIG, name=name),
        lambda: Load(name, 1.0),
        lambda: replace(RIG.drives[0], name=name),
        lambda: models.loads(models.dumps(RIG).replace('"overhead_crane"', json.dumps(name))),
        lambda: replace(hand, name=name),
        lambda: replace(hand.fingers[0], name=name),
    ):
        with pytest.raises(models.RigError, match="letters, digits, '-' and '_' only") as error:
            build()
        assert "\n" not in str(error.value)
        assert "\x1b" not in str(error.value)
