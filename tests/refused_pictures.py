"""How pictures that cannot be read are refused."""

import pytest

from proxy_renderer.reference.files import read_reference
from proxy_renderer.schema import VibeError


def refused(path, *words):
    with pytest.raises(VibeError) as caught:
        read_reference(path)
    assert caught.value.remedy
    assert "\n" not in str(caught.value)
    for word in words:
        assert word in str(caught.value)
