"""The step `validate`: all surfaces as their files hold them, proven; what tissues break is told by name and place."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from core.errors import InputError, InternalError
from core.mesh import Mesh
from core.processes.preparation.step_log import STEPS, StepLog
from core.processes.validate import METHODS, REFERENCES
from core.processes.written_surfaces import write_and_read_back
from core.schema.finding import Finding, Place, Severity
from core.schema.prepare import PrepareInputs
from core.schema.report import PairReport, StepReport
from core.validation.places import point_of
from core.validation.validate import Validation, validate

PAIR_CODES = {"pair.intersecting": "tissues.cross", "pair.touching": "tissues.cross", "pair.gap_too_small": "tissues.too_close"}


def prove_surfaces(
    inputs: PrepareInputs, layers: Mapping[str, Mesh], tissues: Mapping[str, Mesh], log: StepLog, out_dir: Path
) -> tuple[dict[str, Mesh], Validation]:
    """The surfaces as written and read back, and what is true of them: a ready set, nested as promised.

    Raises: InputError `tissues.*`; InternalError `prepare.not_proven`. Both tell the findings, with places.
    """
    surfaces = {**layers, **tissues}
    delivered = write_and_read_back(surfaces, out_dir)
    validation = log.take(
        "validate", lambda run: validate(delivered, min_gap_mm=inputs.min_gap_mm, run=run), delivered, inputs.min_gap_mm
    )
    _require_tissues_in_place(inputs, list(layers), tissues, validation)
    _require_proven(list(layers), validation)
    gaps = [pair.min_gap_mm for pair in validation.pairs if pair.min_gap_mm is not None]
    apart = f", smallest gap {min(gaps):.3f} mm" if gaps else ""
    log.tell(
        StepReport(
            name="validate",
            title=STEPS["validate"][0],
            summary=f"{len(surfaces)} surfaces in {len(validation.pairs)} pairs: closed, manifold, outward, nested, "
            f"0 intersecting pairs of faces{apart}.",
            numbers={"surfaces": len(surfaces), "faces of all": sum(len(mesh.faces) for mesh in surfaces.values())}
            | ({"smallest gap [mm]": min(gaps)} if gaps else {}),
            methods=METHODS,
            references=REFERENCES,
        ),
        surfaces,
    )
    return delivered, validation


def _require_tissues_in_place(
    inputs: PrepareInputs, layers: list[str], tissues: Mapping[str, Mesh], validation: Validation
) -> None:
    """Raises: InputError `tissues.cross`, `tissues.too_close`, `tissues.outside_layers`, `tissues.not_nested`."""
    pairs = [one for one in validation.findings if one.code in PAIR_CODES and _touches(one, validation, tissues)]
    for code in ("tissues.cross", "tissues.too_close"):
        of_code = tuple(one for one in pairs if PAIR_CODES[one.code] == code)
        if of_code:
            raise InputError(code, "; ".join(one.message for one in of_code[:3]), findings=tuple(pairs), pairs=len(of_code))
    innermost = layers[-1]
    stray = [name for name in tissues if innermost not in _holders(name, validation.nesting)]
    if stray:
        said = {
            name: f"tissue '{name}' is not inside '{innermost}' but directly inside {_quoted(validation.nesting[name])}"
            for name in stray
        }
        raise _misplaced("tissues.outside_layers", said, tissues)
    said = {
        tissue.name: f"tissue '{tissue.name}' is to be next inside '{tissue.inside}', but is so inside "
        f"{_quoted(validation.nesting[tissue.name])}"
        for tissue in inputs.tissues
        if tissue.inside is not None and validation.nesting[tissue.name] != tissue.inside
    }
    if said:
        raise _misplaced("tissues.not_nested", said, tissues)


def _touches(finding: Finding, validation: Validation, tissues: Mapping[str, Mesh]) -> bool:
    """Whether a finding about a pair is about a tissue."""
    return any({pair.a, pair.b} & set(tissues) for pair in validation.pairs if _is_about(finding, pair))


def _is_about(finding: Finding, pair: PairReport) -> bool:
    return {pair.a, pair.b} == {place.mesh for place in finding.places}


def _holders(name: str, nesting: Mapping[str, str | None]) -> list[str]:
    """All surfaces around one, the next one first."""
    around: list[str] = []
    holder = nesting[name]
    while holder is not None and holder not in around:
        around.append(holder)
        holder = nesting[holder]
    return around


def _quoted(name: str | None) -> str:
    return "nothing" if name is None else f"'{name}'"


def _misplaced(code: str, said: Mapping[str, str], tissues: Mapping[str, Mesh]) -> InputError:
    findings = tuple(
        Finding(
            code=code,
            severity=Severity.ERROR,
            message=words,
            count=1,
            places=(Place(mesh=name, point_mm=point_of(tissues[name].vertices.mean(axis=0))),),
        )
        for name, words in said.items()
    )
    return InputError(code, "; ".join(said.values()), findings=findings, tissues=len(findings))


def _require_proven(layers: list[str], validation: Validation) -> None:
    """Never hand out surfaces that break the promise: that would be our bug, and is said with all that is known."""
    chain = dict(zip(layers, (None, *layers), strict=False))
    nested = {name: validation.nesting[name] for name in layers}
    if validation.verdict == "simulation_ready" and nested == chain:
        return
    errors = tuple(finding for finding in validation.findings if finding.severity is Severity.ERROR)
    words = "; ".join(finding.message for finding in errors[:3]) or f"the shells nest as {nested}, not {chain}"
    raise InternalError("prepare.not_proven", f"the surfaces made do not pass the proof: {words}", findings=errors)
