# SPDX-License-Identifier: Apache-2.0
"""`vibe vocabulary`: a word is added only if the file is right with it."""

import pytest

from proxy_renderer.cli.main import main
from proxy_renderer.words.lexicon.vocabulary import VARIABLE


@pytest.fixture
def own(tmp_path, monkeypatch):
    monkeypatch.setenv(VARIABLE, "")
    return tmp_path / "own.toml"


def test_a_look_and_colors_are_added_read_and_listed(own, capsys):
    at = ["--vocabulary", str(own)]
    assert main(["vocabulary", "add", "midnight plum", "--color", "#3a1238", *at]) == 0
    assert (
        main(
            ["vocabulary", "add", "brand red", "--words", "house red", "--wish", "material/roughness 0.1..0.2 !2", *at]
        )
        == 0
    )
    assert main(["vocabulary", "add", "studio sky", "--color", "#88aadd", *at]) == 0
    capsys.readouterr()
    assert main(["vocabulary", "list", "house", *at]) == 0
    assert "brand red (material): house red" in capsys.readouterr().out
    assert main(["vocabulary", "test", "midnight plum cup", *at]) == 0
    assert "midnight plum" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--wish", "material/roughnes 0.1..0.2"], "names no parameter"),
        (["--color", "red"], "is not a color"),
        ([], "needs a color"),
        (["--means", "glossy", "--slot", "smell"], "no known slot"),
    ],
)
def test_a_mistake_leaves_the_file_as_it_was(own, capsys, options, said):
    own.write_text('[colors]\n"a" = "#112233"\n', encoding="utf-8")
    assert main(["vocabulary", "add", "new", *options, "--vocabulary", str(own)]) == 2
    assert said in capsys.readouterr().err
    assert own.read_text(encoding="utf-8") == '[colors]\n"a" = "#112233"\n'
    assert [path.name for path in own.parent.iterdir()] == ["own.toml"]


def test_a_name_is_not_taken_twice(own, capsys):
    command = ["vocabulary", "add", "plum", "--color", "#3a1238", "--vocabulary", str(own)]
    assert [main(command), main(command)] == [0, 2]
    assert "already" in capsys.readouterr().err
