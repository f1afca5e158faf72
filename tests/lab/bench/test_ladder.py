# SPDX-License-Identifier: Apache-2.0
"""How far values differ from seed to seed."""

import pytest

from lab.bench.ladder.rungs import run, spread
from proxy_renderer.schema import VibeError


def report(power, color, moved=0.5):
    return {
        "light/Key/power": {"after": power, "moved": moved},
        "material/Body/base_color": {"after": color, "moved": moved},
        "film/contrast": {"after": 1.0, "moved": 0.0},
    }


def test_values_that_agree_have_no_spread_and_what_nothing_moved_is_not_counted():
    assert spread([report(10.0, [0.1, 0.2, 0.3])] * 3) == 0.0
    assert spread([report(10.0, [0.1, 0.2, 0.3], moved=0.0)] * 2) == 0.0


def test_spread_is_a_share_of_the_range_on_the_perceptual_scale():
    """A color's component from black to white is the whole range; a doubled power is less of it than a tenfold one."""
    black_or_white = [report(10.0, [0.0, 0.2, 0.3]), report(10.0, [1.0, 0.2, 0.3])]
    assert spread(black_or_white) == pytest.approx(0.5)  # the mean of two parameters
    twofold, tenfold = (spread([report(10.0, [0, 0, 0]), report(p, [0, 0, 0])]) for p in (20.0, 100.0))
    assert 0 < twofold < tenfold < 0.5


def test_no_rung_of_a_name_is_said(tmp_path):
    with pytest.raises(VibeError, match="No rung has a name like 'magic'") as refused:
        run(tmp_path, only="*duck*", rungs="magic")
    assert "without sharing" in refused.value.remedy
