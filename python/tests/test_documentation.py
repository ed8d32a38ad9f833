"""Runs the examples of the docstrings and of README."""

import doctest
from pathlib import Path

import fivebar

PROJECT = Path(__file__).resolve().parents[1]


def test_docstrings_are_right():
    runner = doctest.DocTestRunner()
    names = vars(fivebar).copy()
    for test in doctest.DocTestFinder().find(fivebar, "fivebar", module=False, globs=names):
        runner.run(test)
    assert runner.failures == 0
    assert runner.tries > 15


def test_readme_is_right():
    tested = doctest.testfile(str(PROJECT / "README.md"), module_relative=False, encoding="utf-8")
    assert tested.failed == 0
    assert tested.attempted > 5


def test_every_public_name_is_documented():
    for name in fivebar.__all__:
        assert name == "NO_MISMATCH" or getattr(fivebar, name).__doc__, name
    for name in dir(fivebar.Arm):
        assert name.startswith("_") or getattr(fivebar.Arm, name).__doc__, name
