# SPDX-License-Identifier: GPL-3.0-or-later
"""The stubs and the module have the same names, and everything has a docstring."""
import ast
import inspect
from pathlib import Path

import pytest
import todbench as tb

TREE = ast.parse((Path(tb.__file__).parent / "__init__.pyi").read_text())
TOP = {node.name: node for node in TREE.body if isinstance(node, (ast.ClassDef, ast.FunctionDef))}


def members(kind):
    return {name for name, value in vars(kind).items() if not name.startswith("_") and (callable(value) or isinstance(
        value, (property, staticmethod)))}


def test_every_public_name_is_in_the_stubs_and_no_other():
    assert set(TOP) == set(tb.__all__)


@pytest.mark.parametrize("name", [name for name in tb.__all__ if inspect.isclass(getattr(tb, name)) and name != "Error"])
def test_every_member_is_in_the_stubs_and_no_other(name):
    in_stubs = {node.name for node in TOP[name].body if isinstance(node, ast.FunctionDef)
                and not node.name.startswith("_")}
    assert in_stubs == members(getattr(tb, name))


@pytest.mark.parametrize("name", [name for name in tb.__all__ if not inspect.isclass(getattr(tb, name))])
def test_arguments_of_functions_have_the_names_of_the_module(name):
    signature = getattr(tb, name).__doc__.splitlines()[0]
    for argument in TOP[name].args.args:
        assert f"{argument.arg}: " in signature
        assert not argument.arg.startswith("arg")


def test_everything_has_a_docstring():
    for name in tb.__all__:
        value = getattr(tb, name)
        documented = [(name, value)]
        if inspect.isclass(value):
            documented += [(f"{name}.{member}", vars(value)[member]) for member in members(value)]
        for path, one in documented:
            text = (one.__func__ if isinstance(one, staticmethod) else one).__doc__ or ""
            # A function without a comment has its signature alone.
            words = text if inspect.isclass(one) or isinstance(one, property) else text.partition("\n")[2]
            assert words.strip(), path


def test_docstrings_are_the_comments_of_the_headers(source):
    header = (source / "tod/psychometric/psychometric_fit.h").read_text()
    assert tb.PsychometricFit.threshold.__doc__ in header
    assert tb.fit_psychometric.__doc__.split("\n\n")[1].strip().splitlines()[0] in header
