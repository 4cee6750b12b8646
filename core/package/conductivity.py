"""Default conductivities at low frequency, with their sources. Every value is a suggestion: solvers read them from text files."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

from core.errors import InputError

SIMNIBS = "SimNIBS standard conductivities"
CITATION = (
    "A. Thielscher, A. Antunes, G. B. Saturnino, Field modeling for transcranial magnetic stimulation: a useful tool to "
    "understand the physiological effects of TMS?, EMBC 2015, doi:10.1109/EMBC.2015.7318340"
)
FREQUENCY = "quasi-static: brain stimulation, EEG; up to some 10 kHz"
FREQUENCY_NOTE = (
    f"Default conductivities are {SIMNIBS} ({CITATION}); they are {FREQUENCY}. Those of tissues rise with frequency, and above "
    "some 100 kHz permittivity counts, too: give your own as conductivities_s_per_m."
)


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


def conductivities(
    names: Iterable[str], own: Mapping[str, float], packed: Mapping[str, float] = MappingProxyType({})
) -> dict[str, float]:
    """Name -> S/m: the caller's own, else that of the package it came in, else the default.

    Raises: InputError `conductivity.unknown_tissue` if `own` has other names."""
    tissues = list(names)
    unknown = sorted(set(own) - set(tissues))
    if unknown:
        raise InputError(
            "conductivity.unknown_tissue",
            f"conductivities_s_per_m names {', '.join(unknown)}, the tissues are {', '.join(tissues)}",
        )
    return {name: own.get(name, packed.get(name, conductivity_of(name))) for name in tissues}


def conductivity_of(name: str) -> float:
    """The default for a tissue's name in S/m."""
    return look_up(name).siemens_per_metre
