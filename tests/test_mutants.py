"""The faults of `make mutants` can be planted, and what is noticed is told from what is not."""

import ast
from collections import Counter

import pytest
from mutants.run import AS_IT_IS, ROOT, Fault, Found, enough, faults, try_out

FAULTS = faults()


def test_there_are_enough_faults_and_each_has_a_name_of_its_own():
    assert len(FAULTS) >= 30
    assert max(Counter(fault.name for fault in FAULTS).values()) == 1


@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.name)
def test_a_fault_stands_once_in_its_file_and_leaves_python(fault, tmp_path):
    copy = tmp_path / fault.file
    copy.parent.mkdir(parents=True)
    before = (ROOT / fault.file).read_text(encoding="utf-8")
    copy.write_text(before, encoding="utf-8")
    fault.plant(tmp_path)
    after = copy.read_text(encoding="utf-8")
    assert ast.dump(ast.parse(after)) != ast.dump(ast.parse(before))
    assert fault.tests
    for name in fault.tests:
        assert (ROOT / name).is_file()


def test_a_fault_whose_text_is_gone_is_named(tmp_path):
    (tmp_path / "a.py").write_text("x = 1\n", encoding="utf-8")
    with pytest.raises(SystemExit, match="stands 0 times"):
        Fault("gone", "a.py", "y = 2", "y = 3").plant(tmp_path)


def test_a_planted_fault_is_noticed():
    quick = ("tests/models/test_values.py",)
    wrong = Fault(
        "any number is taken",
        "models/values.py",
        "isinstance(value, Real) and not isinstance(value, bool)",
        "not isinstance(value, bool)",
        quick,
    )
    found = try_out((wrong, ("tests",), False))
    assert found.by["tests"].startswith("tests/models/test_values.py::")


def test_what_is_missing_to_the_goals_is_said():
    none = {"tests": "t", "regress": "", "stress": ""}
    both = {"tests": "t", "regress": "", "stress": "wrong"}
    assert enough([Found("a", both), Found("b", both)]) == []
    assert enough([Found("a", both), Found("b", none)]) == [
        "regress and stress notice 50%, it must be 80%"
    ]
    assert enough([Found("a", {"tests": ""})]) == ["no test notices: a"]
    assert AS_IT_IS not in [fault.name for fault in FAULTS]
