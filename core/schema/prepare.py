"""Inputs of the process `prepare`: the keys of `shells` and `ears`, and what every other step is asked."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from core.schema.conductivities import Conductivity, ConductivityInputs
from core.schema.decimate import DecimateInputs, DecimateParameters
from core.schema.detach import DetachSettings
from core.schema.ears import (
    THESIS_DEPTHS_MM,
    Canals,
    EarBoxes,
    EarDepths,
    EarsInputs,
    GeneratedCanals,
    OtherRegions,
)
from core.schema.heal import HealInputs, HealParameters
from core.schema.model import FrozenModel
from core.schema.reference import MeshReference
from core.schema.separate import Priority, SeparateInputs
from core.schema.shells import (
    DEFAULT_LAYERS,
    BlendMm,
    Layers,
    Region,
    ShellsInputs,
    SkinShiftMm,
    ThinPolicy,
    require_distinct,
    require_ordered,
    require_tissues,
)
from core.schema.smooth import SmoothInputs, SmoothParameters
from core.schema.tetrahedralize import TetrahedraParameters
from core.schema.validate import MeshName

# outputs of the process itself, its skin, and BEM-FMM's word for air
RESERVED_NAMES = ("skin", "package", "msh", "vtu", "steps", "report", "report_html", "FreeSpace")


class InnerTissue(FrozenModel):
    """A closed surface inside the innermost layer: an organ, a bone, a part of the brain."""

    name: MeshName
    mesh: MeshReference = Field(description="Its closed surface")
    conductivity_s_per_m: Conductivity | None = Field(
        None, description="Default is that of the name, or of muscle if nobody knows it"
    )
    inside: MeshName | None = Field(
        None, description="Layer or tissue that must be the next one around it, or the job is refused. Default: whichever it is"
    )


class SkinSmoothing(SmoothParameters):
    """As `smooth`, but with defaults for a skin that layers are made of: slivers go, anatomy stays."""

    max_shift_mm: float | None = Field(
        0.5, gt=0, le=1000, description="No vertex goes farther from where it was; null: as far as it likes"
    )
    retriangulate: bool = Field(
        True, description="Flip edges towards Delaunay between iterations where the surface is nearly flat (thesis 3.4.2)"
    )


class TissueGaps(FrozenModel):
    """How inner tissues that touch or cross are set apart. Layers stay as they are."""

    gap_mm: float = Field(
        0.1, gt=0, le=10, description="Gap to open between every two tissues and to the innermost layer; at least `min_gap_mm`"
    )
    priority: Annotated[dict[MeshName, Priority], Field(max_length=48)] = Field(
        {}, description="Of two tissues, the one with the higher number stays while the other has room; 0 if not named"
    )
    max_shift_mm: float = Field(5.0, gt=0, le=100, description="No vertex goes farther from where it was")


class PrepareInputs(ConductivityInputs):
    """A skin and the steps on its way to a model. Steps set to null are left out; the defaults are the thesis' full-body case."""

    skin: MeshReference = Field(description="The outer surface of a body, fit or not")
    heal: HealParameters | None = Field(
        HealParameters(), description="Mend the skin first; a fit one stays as it is. null: an unfit skin is refused"
    )
    decimate: DecimateParameters | None = Field(None, description="Thin the skin out before layers are made from it")
    detach: DetachSettings | None = Field(
        None, description="Set parts of the skin apart that are grown together where they touch, such as arms and torso"
    )
    smooth: SkinSmoothing | None = Field(
        None, description="Better triangles of the skin, or less noise; slivers leave layers no room"
    )
    ears: Literal["auto"] | EarBoxes | None = Field(
        None, description="`auto` finds both ears of a whole body; or their boxes. Layers are thinner there"
    )
    canals: Canals = ()
    generate_canals: GeneratedCanals = None
    layers: Layers = DEFAULT_LAYERS
    ear_depths_mm: EarDepths = Field(
        THESIS_DEPTHS_MM, description="Layer name -> depth in the ears and in the walls of their canals; only with `ears`"
    )
    blend_mm: BlendMm = 5.0
    regions: OtherRegions = ()
    thin_policy: ThinPolicy = "adapt"
    min_gap_mm: float = Field(0.05, gt=0, le=10, description="Smallest distance allowed between any two surfaces")
    skin_shift_mm: SkinShiftMm = 0.0
    tissues: Annotated[tuple[InnerTissue, ...], Field(max_length=48)] = Field(
        (), description="Closed surfaces inside the innermost layer, in any order, nested or side by side"
    )
    separate: TissueGaps | None = Field(
        TissueGaps(), description="Move tissues that touch or cross apart, as little as possible. null: they are refused"
    )
    tetrahedra: TetrahedraParameters | None = Field(
        TetrahedraParameters(), description="Fill all tissues with tetrahedra, a region each. null: surfaces only"
    )

    @model_validator(mode="after")
    def _consistent(self) -> PrepareInputs:
        require_distinct(self.layers)
        if self.detach is not None and self.detach.pieces != 1:
            raise ValueError("detach.pieces must be 1: layers are made of one skin")
        if self.ears is None:
            if self.canals or self.generate_canals is not None:
                raise ValueError("canals are cut into ears: they go with `ears`")
            for region in self.regions:
                require_ordered(f"region '{region.name}'", self.layers, region.depths_mm)
        else:
            self.as_ears()
        names = [*(layer.name for layer in self.layers), *(tissue.name for tissue in self.tissues)]
        # names become outputs and files, and some file systems do not tell cases apart
        if len({name.lower() for name in (*names, *RESERVED_NAMES)}) != len(names) + len(RESERVED_NAMES):
            raise ValueError(f"layers and tissues must differ from each other and from {', '.join(RESERVED_NAMES)}: {names}")
        for tissue in self.tissues:
            if tissue.inside is not None and (tissue.inside not in names or tissue.inside == tissue.name):
                raise ValueError(f"tissue '{tissue.name}' is to be inside '{tissue.inside}'; there are {', '.join(names)}")
        require_tissues(self.conductivities_s_per_m, ["skin", *names])
        with_own = {tissue.name for tissue in self.tissues if tissue.conductivity_s_per_m is not None}
        twice = sorted(with_own & set(self.conductivities_s_per_m))
        if twice:
            raise ValueError(f"conductivities_s_per_m and tissues both give that of {', '.join(twice)}")
        inner = {tissue.name for tissue in self.tissues}
        if self.separate is not None and set(self.separate.priority) - inner:
            raise ValueError(f"priority names {sorted(set(self.separate.priority) - inner)}, the tissues are {sorted(inner)}")
        return self

    def as_heal(self) -> HealInputs:
        """The request of the step; `heal` is not null."""
        asked = {} if self.heal is None else self.heal.model_dump()
        return HealInputs.model_validate({"mesh": self.skin, "min_gap_mm": self.min_gap_mm, **asked})

    def as_decimate(self) -> DecimateInputs:
        """The request of the step; `decimate` is not null."""
        asked = {} if self.decimate is None else self.decimate.model_dump()
        return DecimateInputs.model_validate({"mesh": self.skin, "min_gap_mm": self.min_gap_mm, **asked})

    def as_smooth(self) -> SmoothInputs:
        """The request of the step; `smooth` is not null."""
        asked = {} if self.smooth is None else self.smooth.model_dump()
        return SmoothInputs.model_validate({"mesh": self.skin, "min_gap_mm": self.min_gap_mm, **asked})

    def as_ears(self) -> EarsInputs:
        """The request of the step; `ears` is not null."""
        return EarsInputs(
            skin=self.skin,
            ears="auto" if self.ears is None else self.ears,
            canals=self.canals,
            generate_canals=self.generate_canals,
            layers=self.layers,
            ear_depths_mm=self.ear_depths_mm,
            blend_mm=self.blend_mm,
            regions=self.regions,
            thin_policy=self.thin_policy,
            min_gap_mm=self.min_gap_mm,
            skin_shift_mm=self.skin_shift_mm,
        )

    def as_separate(self, innermost: str) -> SeparateInputs:
        """The request of the step, for tissues inside the layer of that name; there are tissues, and `separate` is not null."""
        asked = TissueGaps() if self.separate is None else self.separate
        names = {innermost, *(tissue.name for tissue in self.tissues)}
        return SeparateInputs(
            meshes={innermost: self.skin, **{tissue.name: tissue.mesh for tissue in self.tissues}},
            min_gap_mm=max(asked.gap_mm, self.min_gap_mm),
            fixed=(innermost,),
            priority=asked.priority,
            inside={tissue.name: tissue.inside for tissue in self.tissues if tissue.inside in names},
            max_shift_mm=asked.max_shift_mm,
        )

    def as_shells(self, ears: tuple[Region, ...]) -> ShellsInputs:
        """The request of the layers, with the ears as plain regions."""
        return ShellsInputs(
            skin=self.skin,
            layers=self.layers,
            regions=(*ears, *self.regions),
            thin_policy=self.thin_policy,
            min_gap_mm=self.min_gap_mm,
            skin_shift_mm=self.skin_shift_mm,
        )
