"""One colour per tissue, the same in every figure and table."""

from __future__ import annotations

from collections.abc import Sequence

Colour = tuple[int, int, int]

# dark enough for a 1 px line on white, apart from each other for colour-blind readers (they differ in lightness too)
TISSUE_COLOURS: dict[str, Colour] = {
    "skin": (122, 76, 44),
    "fat": (226, 155, 0),
    "average_body": (178, 34, 52),
    "muscle": (178, 34, 52),
    "bone": (96, 108, 118),
    "skull": (96, 108, 118),
    "csf": (24, 128, 178),
    "gm": (120, 94, 150),
    "wm": (62, 58, 110),
    "cartilage": (52, 140, 110),
}
OTHER_COLOURS: tuple[Colour, ...] = ((0, 114, 140), (204, 92, 30), (84, 130, 53), (150, 60, 120), (70, 80, 160), (140, 110, 20))


def tissue_colours(names: Sequence[str]) -> dict[str, Colour]:
    """A colour for each name, known tissues their own, the others in order."""
    chosen: dict[str, Colour] = {}
    for name in names:
        known = TISSUE_COLOURS.get(name.lower().replace("-", "_"))
        taken = set(chosen.values())
        if known is None or known in taken:
            free = [colour for colour in OTHER_COLOURS if colour not in taken]
            known = free[0] if free else OTHER_COLOURS[len(chosen) % len(OTHER_COLOURS)]
        chosen[name] = known
    return chosen


def lightened(colour: Colour, share: float) -> Colour:
    """The colour mixed with white; 0 leaves it, 1 is white."""
    red, green, blue = (round(channel + (255 - channel) * share) for channel in colour)
    return red, green, blue


def as_hex(colour: Colour) -> str:
    """`#rrggbb` for CSS and matplotlib."""
    return "#{:02x}{:02x}{:02x}".format(*colour)
