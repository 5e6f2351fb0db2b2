# SPDX-License-Identifier: BSD-3-Clause
"""Names, docstrings, stubs, and what notebooks show."""
import ast
import inspect
import os
import re

import pytest
from conftest import bumps

import pcl_slim

FOLDER = os.path.dirname(pcl_slim.__file__)


def stub():
    with open(os.path.join(FOLDER, "_pcl_slim.pyi"), encoding="utf-8") as file:
        return ast.parse(file.read())


def test_everything_has_a_docstring():
    assert pcl_slim.__doc__ and re.fullmatch(r"\d+\.\d+\.\d+", pcl_slim.__version__)
    for name in pcl_slim.__all__:
        thing = getattr(pcl_slim, name)
        if name == "__version__":
            continue
        assert len(inspect.getdoc(thing)) > 40, name
        if inspect.isclass(thing):
            assert thing.__module__ == "pcl_slim", name
            for member in vars(thing):
                if not member.startswith("_") and not hasattr(tuple, member) and not issubclass(thing, tuple):
                    assert inspect.getdoc(getattr(thing, member)), (name, member)


def test_stubs_name_what_is_there():
    tree = stub()
    names = {node.name for node in tree.body if isinstance(node, (ast.FunctionDef, ast.ClassDef))}
    assert names == {name for name in pcl_slim.__all__ if name != "__version__"}
    for node in tree.body:
        thing = getattr(pcl_slim, getattr(node, "name", ""), None)
        if not isinstance(node, ast.ClassDef) or issubclass(thing, (tuple, Exception)):
            continue
        told = {member.name for member in node.body if isinstance(member, ast.FunctionDef)}
        there = {name for name in vars(thing) if not name.startswith("_")}
        assert {name for name in told if not name.startswith("_")} == there, node.name


def test_stubs_name_the_options():
    """All options of fit, which an unknown one lists."""
    with pytest.raises(TypeError) as error:
        pcl_slim.fit([[0.0, 0, 0]], unknown=1)
    there = set(str(error.value).rpartition("it takes ")[2].split(", "))
    node = next(node for node in stub().body if getattr(node, "name", "") == "fit")
    assert {argument.arg for argument in node.args.kwonlyargs} == there
    assert all(re.search(r"\b%s\b" % name, pcl_slim.fit.__doc__) for name in there)


def test_representations():
    points, colors = bumps(10000)
    surface = pcl_slim.fit(points, colors=colors)
    assert re.fullmatch(r"<pcl_slim\.Surface: \d+ leaves of degree 4, \d levels, fitted to 10000 points, noise 0\.00\d+.*"
                        r"(coloured|textured)>", repr(surface)), repr(surface)
    assert repr(surface.mesh(tolerance=0.01)).endswith("1 component, closed, coloured>")
    assert re.match(r"<pcl_slim\.Lines: \d+ ridges and \d+ ravines", repr(surface.lines(points)))
    splats = pcl_slim.splats(points, colors, max_splats=500)
    assert repr(splats) == "<pcl_slim.Splats: %d discs of 10000 points, coloured>" % len(splats)
    assert repr(pcl_slim.Camera((1, 2, 3), (0, 0, 0))).startswith("pcl_slim.Camera(position=(1, 2, 3)")
    for shown in (surface, splats):
        frame = shown._repr_html_()
        assert frame.startswith("<iframe srcdoc=\"&lt;!") and frame.endswith("</iframe>") and frame.count('"') == 8
