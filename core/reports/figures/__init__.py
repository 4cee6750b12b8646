"""Pictures of shells and meshes: one file per kind of figure, `compose` chooses."""

from core.reports.figures.compose import draw_mesh_figures, draw_shell_figures
from core.reports.figures.figure import Figure

__all__ = ["Figure", "draw_mesh_figures", "draw_shell_figures"]
