"""Default conductivities at low frequency, with their sources. Every value is a suggestion: solvers read them from text files."""

from __future__ import annotations

from dataclasses import dataclass

SIMNIBS = "SimNIBS standard conductivities"


@dataclass(frozen=True, slots=True)
class Conductivity:
    """siemens_per_metre of the tissue, where the number comes from, and whether the name was known."""

    siemens_per_metre: float
    source: str
    known: bool = True


_MUSCLE = Conductivity(0.16, f"{SIMNIBS}, muscle (10)")
_TABLE: dict[str, Conductivity] = {
    "whitematter": Conductivity(0.126, f"{SIMNIBS}, white matter (1)"),
    "greymatter": Conductivity(0.275, f"{SIMNIBS}, grey matter (2)"),
    "csf": Conductivity(1.654, f"{SIMNIBS}, CSF (3)"),
    "bone": Conductivity(0.010, f"{SIMNIBS}, bone (4)"),
    "skin": Conductivity(0.465, f"{SIMNIBS}, scalp (5)"),
    "muscle": _MUSCLE,
    "averagebody": Conductivity(0.16, f"{SIMNIBS}, muscle (10), taken for the average of what lies below the fat"),
    "cartilage": Conductivity(0.88, f"{SIMNIBS}, cartilage (11)"),
    "fat": Conductivity(0.078, f"{SIMNIBS}, fat (12)"),
}
_OTHER_WORDS = {
    "wm": "whitematter",
    "gm": "greymatter",
    "graymatter": "greymatter",
    "cerebrospinalfluid": "csf",
    "skull": "bone",
    "scalp": "skin",
    "body": "averagebody",
    "avgbody": "averagebody",
    "innerbody": "averagebody",
    "subcutaneousfat": "fat",
    "sat": "fat",
}


def tissue_word(name: str) -> str:
    """The one word under which tables know a tissue, if they do; case, spaces, `_` and `-` do not matter."""
    key = "".join(letter for letter in name.lower() if letter.isalnum())
    return _OTHER_WORDS.get(key, key)


def look_up(name: str) -> Conductivity:
    """The default for a tissue's name; case, spaces, `_` and `-` do not matter. An unknown name gets the value of muscle."""
    found = _TABLE.get(tissue_word(name))
    if found is not None:
        return found
    return Conductivity(_MUSCLE.siemens_per_metre, f"no default for this name; {_MUSCLE.source} was taken", known=False)


def conductivity_of(name: str) -> float:
    """The default for a tissue's name in S/m."""
    return look_up(name).siemens_per_metre
