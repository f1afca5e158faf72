# SPDX-License-Identifier: Apache-2.0
"""Further sentences: which of them speak of earlier steps, and what is left of the others."""

import pytest

from proxy_renderer.schema import VibeError
from proxy_renderer.schema.sentences import about_steps, plain


@pytest.mark.parametrize(
    ("sentence", "kind", "number", "factor", "what", "new"),
    [
        ("no take me back to the candle", "show", -1, 1.0, "candle", ""),
        ("halfway back to noon", "between", -1, 1.0, "noon", ""),
        ("one step back", "show", -1, 1.0, "", ""),
        ("too much magenta, pull it back by half", "strength", -1, 0.5, "", ""),
        ("the grade's too strong, dial it back to half", "strength", -1, 0.5, "", ""),
        ("vignette out again, grain can stay", "without", -1, 1.0, "vignette", ""),
        ("not the hair, the coat", "instead", -1, 1.0, "hair", "coat"),
        ("hm, go back to the first one please", "show", 1, 1.0, "", ""),
        ("nah, the one before", "show", -1, 1.0, "", ""),
        ("50/50 with the first", "between", 1, 1.0, "", ""),
        ("too much, dial it down by half", "strength", -1, 0.5, "", ""),
        ("ok but 30% less", "strength", -1, 0.7, "", ""),
        ("actually drop the haze completely, keep the sun", "without", -1, 1.0, "haze", ""),
        ("lamps only, not the signs", "instead", -1, 1.0, "signs", "lamps"),
        ("no not the floor! only the wall", "instead", -1, 1.0, "floor", "wall"),
        ("nice, but not the scarf, that one stays cloth", "except", -1, 1.0, "scarf", ""),
        ("Back to the first.", "show", 1, 1.0, "", ""),
        ("no, back to step 2", "show", 2, 1.0, "", ""),
        ("go back to the original look", "show", 0, 1.0, "", ""),
        ("undo that", "show", -1, 1.0, "", ""),
        ("something between this and the first", "between", 1, 1.0, "", ""),
        ("half as strong", "strength", -1, 0.5, "", ""),
        ("and now twice as strong", "strength", -1, 2.0, "", ""),
        ("same mood without the fog", "without", -1, 1.0, "fog", ""),
        ("without the vignette", "without", -1, 1.0, "vignette", ""),
        ("no, the wall, not the table", "instead", -1, 1.0, "table", "wall"),
        ("but leave the sky as it is", "except", -1, 1.0, "sky", ""),
        ("except for the red car", "except", -1, 1.0, "red car", ""),
    ],
)
def test_a_sentence_about_steps_is_told_from_a_look(sentence, kind, number, factor, what, new):
    assert about_steps(sentence) == (kind, number, factor, what, new, "")


@pytest.mark.parametrize(
    ("sentence", "kind", "number", "rest"),
    [
        ("hmm, back to the first one, just a little darker", "show", 1, "just a little darker"),
        ("back to the first, but with a rim light", "show", 1, "with a rim light"),
        ("halfway between this and step 2 but warmer", "between", 2, "warmer"),
        ("that's a bit too heavy, go halfway between this and the first one", "between", 1, ""),
    ],
)
def test_after_a_return_something_else_may_be_done(sentence, kind, number, rest):
    said = about_steps(sentence)
    assert said
    assert (said.kind, said.number, said.rest) == (kind, number, rest)


@pytest.mark.parametrize(
    "sentence",
    [
        "a bit warmer",
        "warm light, but leave the key light as it is",
        "back light",
        "no fog",
        "warmer, but leave the sky",
        "between the trees",
        "",
        "lamp off",
        "lights out",
        "turn off the lamp",
        "kill the rim light",
        "the rim light not on the wall",
        "the lamp does not light the wall",
    ],
)
def test_a_look_is_no_sentence_about_steps(sentence):
    assert about_steps(sentence) is None


@pytest.mark.parametrize(
    ("sentence", "text", "factor"),
    [
        ("And now a touch warmer", "a bit warmer", 0.0),
        ("make it even darker", "darker", 0.0),
        ("twice as much fog", "more fog", 2.0),
        ("half the fog", "less fog", 0.5),
        ("a lot more contrast", "much more contrast", 0.0),
        ("key about a stop brighter", "key brighter", 2.0),
        ("two stops down", "darker", 0.25),
        ("lamp half as strong", "lamp dimmer", 0.5),
        ("more haze, like 50% more", "more haze", 1.5),
        ("now bring the red back on the scarf", "bring the red on the scarf", 0.0),
        ("cooler, but not the clock", "cooler, but leave the clock", 0.0),
        ("keep everything but make the cap rose gold", "make the cap rose gold", 0.0),
        ("floor not that shiny", "floor less shiny", 0.0),
        ("the jug gets lost, bring it up without touching the wall", "the jug brighter, but leave the wall", 0.0),
        ("Nice, but the lamp is burning out the wall, halve it", "less lamp", 0.5),
        ("still reads like daytime, take it down a stop and a half", "darker", 2.0**-1.5),
        ("take the lamp down a stop", "the lamp darker", 0.5),
        ("too much smoke, I can barely see the tiles in the back", "less smoke", 0.0),
        ("rust the metal, it looks fresh from the factory", "rust the metal", 0.0),
        ("swing the sun round to the left so the door side gets hit", "sun from the left", 0.0),
        ("the flame is too yellow, push it toward amber", "the flame more amber", 0.0),
        ("it's too dark, more contrast", "less dark, more contrast", 0.0),
        ("make it look like dusk, warmer", "look like dusk, warmer", 0.0),
        ("lit as if by candles", "lit as if by candles", 0.0),
        ("less fog, key a stop over", "less fog, key brighter", 2.0),
        ("less fog, the key a stop", "less fog, the key brighter", 2.0),
        ("backdrop darker, like half", "backdrop darker", 0.5),
        ("fog thicker, maybe 50% more", "fog thicker", 1.5),
        ("key a third darker", "key a third darker", 0.0),
        ("a bit warmer still", "a bit warmer", 0.0),
        ("sat down a bit", "less saturation a bit", 0.0),
        ("and a rim light", "a rim light", 0.0),
        ("softer shadows, they're a bit hard", "softer shadows", 0.0),
        ("more contrast, the walls look flat", "more contrast", 0.0),
        ("sconces too bright, take them down a bit", "the sconces a bit darker", 0.0),
        ("key brighter, sun down by half", "key brighter, sun darker", 0.0),
        ("sun down by half", "sun darker", 0.5),
        ("lamps 1.5x brighter", "lamps brighter", 1.5),
        ("2 times darker", "darker", 0.5),
        ("half as red, more contrast", "less red, more contrast", 0.5),
        ("a touch less orange overall", "a bit cooler", 0.0),
        ("the vase less orange", "the vase less orange", 0.0),
        # verbs and complaints compare
        ("slightly darken the wall", "the wall a bit darker", 0.0),
        ("warm the lamp up a bit", "the lamp a bit warmer", 0.0),
        ("the fog is too thick", "the fog less thick", 0.0),
        ("too dark, open the shadows a stop", "shadows lighter", 0.0),
        ("pull the magenta back a lot", "much less magenta", 0.0),
        ("cut the pink by half", "less pink", 0.5),
        ("lamp 30% brighter", "lamp brighter", 1.3),
        ("fog, but thin", "thin fog", 0.0),
        ("turn off the floor lamp", "floor lamp switched off", 0.0),
        # what is said about the present look is no wish
        ("the fog hides the cabin, pull it back", "less fog", 0.0),
        ("shadows came out blueish, warmer", "warmer", 0.0),
        ("what happened to the wheels, they should be black", "they should be black", 0.0),
        ("why is the glass so dull? it needs to sparkle", "the glass needs to sparkle", 0.0),
        ("more haze between the trees, about twice as much", "more haze between the trees", 2.0),
        ("make the cars matte black, not the rims though", "make the cars matte black, but leave the rims", 0.0),
        ("turn the lamps down by half but keep the shop as it is", "the lamps darker, but leave the shop", 0.5),
        ("give the hair a cool rim", "a cool rim light on the hair", 0.0),
        ("its a little overexposed", "its a bit darker", 0.0),
        ("the cup is copper, the table dark walnut", "the cup is copper, the table dark walnut", 0.0),
    ],
)
def test_what_is_left_of_a_sentence_is_as_prompts_say_it(sentence, text, factor):
    assert plain(sentence)[:2] == (text, factor)


def test_a_sentence_that_only_describes_the_image_is_refused():
    with pytest.raises(VibeError, match="says how the image is"):
        plain("fog is good, the green isn't")
