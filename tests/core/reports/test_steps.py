"""Reports of several steps: every step has a section, its figures and its place in the methods."""

import re

from core.reports.figures import Figure
from core.reports.html import render_html
from core.reports.steps import figures_of_step, joined_methods
from core.schema.finding import Finding, Severity
from core.schema.report import Report, StepReport

LIBIGL, MAKAROV, OTHER = "A. Jacobson, libigl", "S. N. Makarov, Low-Frequency", "A. Htet, Full-body Shell Creation"
# the smallest PNG: a report reads its size only
PNG = b"\x89PNG\r\n\x1a\n\x00\x00\x00\rIHDR\x00\x00\x00\x07\x00\x00\x00\x05\x08\x02\x00\x00\x00"


def step(name: str, **more: object) -> StepReport:
    return StepReport.model_validate({"name": name, "title": name.title(), "summary": f"What {name} did.", **more})


def test_works_cited_twice_stand_once_and_numbers_follow():
    first = step("load", methods="Checked [2] and proven [1].", references=(f"[1] {LIBIGL}", f"[2] {MAKAROV}"))
    second = step("layers", methods="Moved as in [1], proven [2].", references=(f"[1] {OTHER}", f"[2] {LIBIGL}"))
    methods, references = joined_methods([first, second])
    assert methods == "Checked [2] and proven [1]. Moved as in [3], proven [1]."
    assert references == (f"[1] {LIBIGL}", f"[2] {MAKAROV}", f"[3] {OTHER}")


def test_what_was_not_done_is_not_cited():
    skipped = step("heal", outcome="not_needed", methods="Healed [1].", references=(f"[1] {LIBIGL}",))
    failed = step("layers", outcome="failed", methods="Layers were made [1].", references=(f"[1] {OTHER}",))
    assert joined_methods([skipped, step("load"), failed]) == ("", ())


def test_every_step_has_its_section_and_figures_are_numbered_down_the_page():
    figures = (
        *figures_of_step("layers", [Figure("views", "Views", "of layers", PNG)]),
        *figures_of_step("load", [Figure("views", "Views", "of load", PNG)]),
        Figure("views", "Views", "of all", PNG),
    )
    findings = (Finding(code="layer.thin", severity=Severity.WARNING, message="thin at the ear", count=3),)
    report = Report(
        process="prepare",
        verdict="not_ready",
        summary="Stopped at layers.",
        steps=(
            step("load", numbers={"faces": 12345, "longest edge [mm]": 3.14159, "unit": "mm"}),
            step("layers", outcome="failed", findings=findings, checksums={"skin": "ab" * 32}),
            step("tetrahedra", outcome="not_reached"),
        ),
    )
    html = render_html(report, figures)
    captions = re.findall(r"<b>(Figure \d+)\. Views\.</b> (of \w+)", html)
    assert captions == [("Figure 1", "of all"), ("Figure 2", "of load"), ("Figure 3", "of layers")]
    sections = dict(re.findall(r'<section class="step" id="step-(\w+)">(.*?)</section>', html, re.S))
    assert list(sections) == ["load", "layers"]  # what was not done has its line in the list, and no empty section
    assert "12\u202f345" in sections["load"]
    assert "3.142" in sections["load"]
    assert "Thin at the ear" in sections["layers"]
    assert "ab" * 32 in sections["layers"]
    assert '<th scope="row">3. Tetrahedra</th><td class="">not reached</td>' in html
    for name in sections:
        assert f'href="#step-{name}"' in html
    assert 'class="bad">failed' in html


def test_a_figure_of_an_unknown_step_is_still_shown():
    html = render_html(
        Report(process="shells", verdict="not_ready", summary="s"), figures_of_step("gone", [Figure("a", "A", "c", PNG)])
    )
    assert 'id="figure-gone_a"' in html
