# SPDX-License-Identifier: Apache-2.0
"""Every surface comes from the one table: an option that is made up here appears on each of them."""

import argparse
from dataclasses import asdict, dataclass

import pytest

from proxy_renderer.batch.manifest import OptionReader, TomlSource
from proxy_renderer.cli.main import parser
from proxy_renderer.schema import VibeError
from proxy_renderer.schema.options import checks
from proxy_renderer.schema.options import table as options_table
from proxy_renderer.schema.options.table import HEADINGS, SUPPORT, TABLE, TASK, Options, Panel, option, rows


@dataclass(frozen=True)
class Sparkling(Options):
    """The options, and one more."""

    sparkle: int = option(
        3, "how much it sparkles", "effort", bounds=(1, 9), panel=Panel("Sparkle", "How much", (1, 5))
    )


LONGER = (*TASK, *rows(Sparkling), *SUPPORT)


def read(*argv, table=LONGER):
    command = argparse.ArgumentParser(prog="p")
    options_table.add_options(command, HEADINGS, table)
    return command.parse_args(argv), command.format_help()


def test_the_command_line_has_it_with_its_help_and_default():
    given, text = read("--sparkle", "5")
    assert given.sparkle == 5
    assert read()[0].sparkle == 3
    assert "how much it sparkles (default: 3)" in " ".join(text.split())
    assert "--sparkle=5" in options_table.to_arguments(given, LONGER)
    with pytest.raises(SystemExit):
        read("--sparkle", "5", table=TABLE)


def test_its_bounds_are_kept():
    with pytest.raises(VibeError, match="--sparkle 10 is out of range") as caught:
        checks.numbers(read("--sparkle", "10")[0], LONGER)
    assert caught.value.remedy == "Use 1 to 9."


def test_the_message_has_it():
    assert Sparkling.from_dict({"sparkle": 4}).sparkle == 4
    assert asdict(Sparkling())["sparkle"] == 3
    with pytest.raises(VibeError, match="'sparkle'"):
        Options.from_dict({"sparkle": 4})


def test_a_manifest_has_it(tmp_path):
    (tmp_path / "m.toml").write_text("[options]\nsparkle = 4\n")
    source = TomlSource(tmp_path / "m.toml")
    reader = OptionReader(source, tmp_path, LONGER)
    assert reader.read({"sparkle": 4}, ("options",)) == {"sparkle": 4}
    for wrong, words in (("much", "sparkle = 3"), (10, "Use 1 to 9")):
        with pytest.raises(VibeError, match=words) as caught:
            reader.read({"sparkle": wrong}, ("options",))
        assert "m.toml > options > sparkle: " in caught.value.message
    with pytest.raises(VibeError, match="Unknown option 'sparkle'"):
        OptionReader(source, tmp_path).read({"sparkle": 4}, ("options",))


def test_what_vibe_run_hands_over_means_the_same_on_the_other_side():
    """Every option that Blender's side takes, at another value than its default."""
    argv = ["run", "a.blend", "--out=o", "--prompt=noir", "--subject=Cup", "--stage=floor", "--cameras=A,B"]
    argv += ["--frames=1,5", "--grade-each", "--effort=quick", "--rounds=7", "--steps=8", "--starts=2"]
    argv += ["--variants=3", "--top-k=5", "--seed=4", "--groups=light", "--lock=world", "--encoder=e"]
    argv += ["--target=copper=Cup", "--device=cpu", "--vlm-model=m", "--vlm-url=u", "--no-anchor"]
    argv += ["--no-new-lights", "--figures", "--light-mix"]
    argv += ["--like=still.jpg", "--like-only=light", "--like-same", "--goals=g.json"]
    argv += ["--size=64", "--samples=2", "--then=warmer"]
    argv += ["--moments=1: noon; 9: night", "--markers", "--check-every=10", "--steady", "--offset-keys"]
    given = parser().parse_args(argv)
    checks.numbers(given)
    names = [row.name for row in TABLE if row.blender and row.name != "effort"]
    assert all(getattr(given, row.name) != row.command_default for row in TABLE if row.name in names)
    again, _ = read(*options_table.to_arguments(given), table=[row for row in TABLE if row.blender])
    assert {name: getattr(again, name) for name in names} == {name: getattr(given, name) for name in names}


def test_the_engine_is_told_what_the_command_line_says():
    given, _ = read("--rounds=7", "--lock=world", "--no-anchor", "--grade-each", table=TABLE)
    checks.numbers(given)
    told = options_table.engine_options(given, camera=True, online=False)
    assert told == Options(rounds=7, lock=("world",), anchor=False, grade_each=True, camera=True, online=False)
