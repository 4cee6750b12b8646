"""The processes that take surfaces, as methods of the client."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Literal

from integument.event import JobEvent
from integument.job import Job
from integument.local_package import unpack_surfaces
from integument.mesh import Mesh
from integument.region import Point
from integument.result import Output
from integument.upload import Source

Unit = Literal["m", "cm", "mm", "in"]
OnEvent = Callable[[JobEvent], None]
MeshInput = Mesh | Output | Source
"""A mesh the server holds, an output of a job, `/v1/...`, or a file, bytes or open file to upload first."""
SurfacesInput = MeshInput | Mapping[str, MeshInput]
"""One mesh, several by name, or a package: an output of a job, its link, or a `package.zip` (whose depths stay behind)."""

ZIP_TYPE = "application/zip"


class SurfaceProcesses(ABC):
    """`heal`, `decimate`, `smooth`, `detach`, `segment`, `separate`, `tetrahedralize`, `fields`. They take surfaces, upload what
    is needed, queue the job and wait.

    Alone a surface gives the output `mesh`; several, or a package, give `package` and each surface under its name.
    Further inputs go by their names in the process description. Raises: as `upload_mesh`, `execute` and `wait`.
    """

    @abstractmethod
    def execute(self, process_id: str, inputs: Mapping[str, Any], *, idempotency_key: str | None = None) -> Job:
        """Queue a job."""

    @abstractmethod
    def wait(self, job: Job | str, on_event: OnEvent | None = None, *, timeout_s: float | None = None) -> Job:
        """Wait for its end."""

    @abstractmethod
    def _reference(self, mesh: MeshInput, unit: Unit) -> dict[str, str]: ...

    def heal(
        self,
        surfaces: SurfacesInput,
        *,
        pieces: Literal["keep_largest", "keep_above", "keep_all"] = "keep_largest",
        unit: Unit = "mm",
        on_event: OnEvent | None = None,
        **inputs: Any,
    ) -> Job:
        """Make defective surfaces closed, manifold, outward and free of self-intersection with the smallest change."""
        asked = {"pieces": pieces, **inputs, **self._surfaces(surfaces, unit)}
        return self.wait(self.execute("heal", asked), on_event)

    def decimate(
        self,
        surfaces: SurfacesInput,
        *,
        ratio: float | None = None,
        faces: int | None = None,
        max_deviation_mm: float | None = None,
        method: Literal["curvature", "quadric"] = "curvature",
        regions: Mapping[str, tuple[Point, Point, float]] | None = None,
        unit: Unit = "mm",
        on_event: OnEvent | None = None,
        **inputs: Any,
    ) -> Job:
        """Fewer faces; exactly one of `ratio`, `faces` and `max_deviation_mm`.

        regions: name -> lowest and highest corner of a box in mm, and the share of the faces in it that stays.
        """
        targets = {"target_ratio": ratio, "target_faces": faces, "max_deviation_mm": max_deviation_mm}
        asked = {"method": method, **{name: value for name, value in targets.items() if value is not None}, **inputs}
        if regions:
            asked["regions"] = [
                {"name": name, "box_mm": {"min": list(low), "max": list(high)}, "ratio": share}
                for name, (low, high, share) in regions.items()
            ]
        return self.wait(self.execute("decimate", {**asked, **self._surfaces(surfaces, unit)}), on_event)

    def smooth(
        self,
        surfaces: SurfacesInput,
        *,
        method: Literal["standard", "lumped", "cvt", "wcc", "hc", "taubin"] = "hc",
        iterations: int | None = None,
        regions: Mapping[str, tuple[Point, Point]] | None = None,
        unit: Unit = "mm",
        on_event: OnEvent | None = None,
        **inputs: Any,
    ) -> Job:
        """Better triangles or less noise. regions: name -> lowest and highest corner of a box in mm."""
        asked = {"method": method, **({} if iterations is None else {"iterations": iterations}), **inputs}
        if regions:
            asked["regions"] = [
                {"name": name, "box_mm": {"min": list(low), "max": list(high)}} for name, (low, high) in regions.items()
            ]
        return self.wait(self.execute("smooth", {**asked, **self._surfaces(surfaces, unit)}), on_event)

    def detach(
        self,
        skin: MeshInput,
        regions: Mapping[str, tuple[Point, Point] | tuple[Point, Point, int]],
        *,
        gap_mm: float = 1.0,
        pieces: int = 1,
        unit: Unit = "mm",
        on_event: OnEvent | None = None,
        **inputs: Any,
    ) -> Job:
        """Set parts of a skin apart where they touch: output `skin`.

        regions: name -> lowest and highest corner of a box in mm around both parts and their contact, and the number of contacts
        in it if it is not one. pieces: how many there are in the end.
        """
        boxes = [
            {"name": name, "box_mm": {"min": list(box[0]), "max": list(box[1])}, "contacts": box[2] if len(box) > 2 else 1}
            for name, box in regions.items()
        ]
        asked = {"regions": boxes, "gap_mm": gap_mm, "pieces": pieces, **inputs}
        return self.wait(self.execute("detach", {**asked, "skin": self._reference(skin, unit)}), on_event)

    def segment(
        self,
        volume: MeshInput,
        *,
        names: Mapping[int, str] | None = None,
        on_event: OnEvent | None = None,
        **inputs: Any,
    ) -> Job:
        """Closed surfaces of the labels of a volume (NIfTI, MGZ): outputs `package`, and each surface under its name.

        names: label -> name of its surface, labels of one name become one; none: all labels, as label_<number>.
        """
        asked = {"names": {str(label): name for label, name in (names or {}).items()}, **inputs}
        return self.wait(self.execute("segment", {**asked, "volume": self._reference(volume, "mm")}), on_event)

    def separate(
        self,
        surfaces: SurfacesInput,
        *,
        fixed: Sequence[str] = (),
        priority: Mapping[str, int] | None = None,
        inside: Mapping[str, str | None] | None = None,
        unit: Unit = "mm",
        on_event: OnEvent | None = None,
        **inputs: Any,
    ) -> Job:
        """A gap between every two surfaces; `min_gap_mm` is its width, 0.1 if not given.

        fixed: who may not move. priority: of two the one with the higher number stays while the other has room. inside: surface
        -> the one that holds it most closely, None for none; who is missing is found.
        """
        asked = {"fixed": list(fixed), "priority": dict(priority or {}), "inside": dict(inside or {}), **inputs}
        return self.wait(self.execute("separate", {**asked, **self._surfaces(surfaces, unit)}), on_event)

    def tetrahedralize(
        self,
        surfaces: SurfacesInput,
        *,
        radius_edge: float | None = 2.0,
        max_volume_mm3: Mapping[str, float] | None = None,
        unit: Unit = "mm",
        on_event: OnEvent | None = None,
        **inputs: Any,
    ) -> Job:
        """Tetrahedra in all tissues, as outputs `msh` and `vtu`. radius_edge: None adds no vertex but where it must."""
        asked = {"radius_edge": radius_edge, "max_volume_mm3": dict(max_volume_mm3 or {}), **inputs}
        return self.wait(self.execute("tetrahedralize", {**asked, **self._surfaces(surfaces, unit)}), on_event)

    def fields(
        self,
        surfaces: SurfacesInput,
        field: MeshInput,
        *,
        columns: Sequence[str] | None = None,
        coil: MeshInput | None = None,
        placement: Sequence[Sequence[float]] | None = None,
        unit: Unit = "mm",
        field_length_unit: Unit | None = None,
        on_event: OnEvent | None = None,
        **inputs: Any,
    ) -> Job:
        """A solver's field as one value per triangle: outputs `fields` (a zip), `msh`, `statistics`.

        field: .msh, or a matrix of text whose columns are named from left to right. placement: 4 x 4, mm, of the coil.
        field_length_unit: of the places in the field file, that of the surfaces if not given.
        """
        asked: dict[str, Any] = {**inputs, "field": self._reference(field, field_length_unit or unit)}
        if columns is not None:
            asked["columns"] = list(columns)
        if coil is not None:
            asked["coil"] = {"file": self._reference(coil, "mm")}
            if placement is not None:
                asked["coil"]["placement"] = [list(map(float, row)) for row in placement]
        return self.wait(self.execute("fields", {**asked, **self._surfaces(surfaces, unit)}), on_event)

    def _surfaces(self, surfaces: SurfacesInput, unit: Unit) -> dict[str, Any]:
        if isinstance(surfaces, Mapping):
            return {"meshes": {name: self._reference(mesh, unit) for name, mesh in surfaces.items()}}
        if isinstance(surfaces, Output) and surfaces.type == ZIP_TYPE:
            return {"package": {"href": surfaces.href}}
        if isinstance(surfaces, str) and surfaces.startswith("/v1/") and surfaces.endswith("/results/package"):
            return {"package": {"href": surfaces}}
        if isinstance(surfaces, str | Path) and Path(surfaces).suffix.lower() == ".zip":
            with TemporaryDirectory(prefix="integument-") as folder:
                unpacked = unpack_surfaces(Path(surfaces), Path(folder))
                return {"meshes": {name: self._reference(path, "mm") for name, path in unpacked.items()}}
        return {"mesh": self._reference(surfaces, unit)}
