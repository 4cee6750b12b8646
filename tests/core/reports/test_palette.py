"""Colours that readers can tell apart."""

from core.reports.palette import OTHER_COLOURS, TISSUE_COLOURS, as_hex, lightened, tissue_colours


def test_known_tissues_have_their_own_colour_in_any_spelling():
    assert tissue_colours(["Skin", "average-body"]) == {
        "Skin": TISSUE_COLOURS["skin"],
        "average-body": TISSUE_COLOURS["average_body"],
    }


def test_no_two_of_a_usual_set_share_a_colour():
    names = ["skin", "fat", "muscle", "average_body", "skull", "bone", "a", "b", "c"]
    assert len(set(tissue_colours(names).values())) == len(names)


def test_more_names_than_colours_start_over():
    names = [str(number) for number in range(64)]
    assert set(tissue_colours(names).values()) == set(OTHER_COLOURS)


def test_lightening_ends_in_white():
    assert lightened((10, 20, 30), 0.0) == (10, 20, 30)
    assert as_hex(lightened((10, 20, 30), 1.0)) == "#ffffff"
