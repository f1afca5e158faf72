# SPDX-License-Identifier: Apache-2.0
"""The product's method, and plug-ins that are named by the environment."""

import pytest

from proxy_renderer.optimize.rounds.method import VARIABLE, Method, load_method
from proxy_renderer.schema import VibeError


def test_the_product_has_one_method(monkeypatch):
    monkeypatch.delenv(VARIABLE, raising=False)
    assert type(load_method()) is Method


def test_a_plug_in_is_named_by_module_and_class(monkeypatch, tmp_path):
    (tmp_path / "others.py").write_text(
        "from proxy_renderer.optimize.rounds.method import Method\nclass Other(Method):\n    pass\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setenv(VARIABLE, "others:Other")
    assert type(load_method()).__name__ == "Other"


@pytest.mark.parametrize("name", ["nowhere", "nowhere:Method", "json:Method", ":Method"])
def test_one_that_is_not_there_is_refused_in_a_line(name, monkeypatch):
    monkeypatch.setenv(VARIABLE, name)
    with pytest.raises(VibeError, match=f"The method '{name}' cannot be loaded") as refused:
        load_method()
    assert VARIABLE in refused.value.remedy
