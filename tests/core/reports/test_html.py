"""The page: complete, self-contained, and text stays text."""

import base64
import hashlib
import json
import re
from functools import cache
from html.parser import HTMLParser

import numpy as np
import pytest

from core.errors import InternalError
from core.reports.figures import Figure, draw_mesh_figures
from core.reports.html import render_html
from core.reports.scene import viewer
from core.reports.scene.scene import make_scene
from core.reports.scene.viewer import report_viewer
from core.schema.finding import Finding, Place, Severity
from core.schema.report import FailureReport, PairReport, Report, ThicknessReport
from core.validation.validate import validate
from tests.solids import cube, flipped, sphere, without_faces

HOSTILE = "<script>alert('x')</script><img src=//evil.example/a.png onerror=alert(1)>\"'&{{ 7*7 }}"
VOID = {"meta", "img", "br", "link", "input"}


class Page(HTMLParser):
    """Collects tags, their attributes and the text, and checks that every tag is closed in turn."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.text = ""
        self.open: list[str] = []
        self.feed(html)
        self.close()

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        if self.open and self.open[-1] not in ("style", "script"):
            self.text += data


def nested_report(verdict="simulation_ready", **update) -> Report:
    validation = validate({"skin": sphere(30.0, 3), "fat": sphere(29.0, 3)})
    fat = ThicknessReport(
        target_mm=1.0,
        on_target_area=0.98617,
        limited_area=0.0123,
        missed_area=0.001,
        min_mm=0.21,
        max_mm=1.02,
        percentiles_mm={"1": 0.4, "5": 0.9, "25": 1.0, "50": 0.998, "75": 1.0, "95": 1.0, "99": 1.01},
    )
    report = Report(
        process="shells",
        verdict=verdict,
        summary="2 nested shells, 0 intersecting faces.",
        meshes=validation.meshes,
        pairs=validation.pairs,
        thickness={"fat": fat},
        nesting=validation.nesting,
        findings=validation.findings,
        methods="Layers were made by nodal movement [1].",
        references=("[1] A reference, doi:10.1000/1",),
        parameters={"layers": [{"name": "fat", "depth_mm": 1.0}], "skin": {"name": "s", "sha256": "ab" * 32}},
        software={"integument-server": "0.1.0"},
        changes=({"mesh": "skin", "what": "rounded", "largest_shift_mm": 1e-6},),
    )
    return report.model_copy(update=update)


@cache
def drawn() -> Figure:
    return draw_mesh_figures({"a": cube(10.0)})[-1]


def picture(name: str) -> Figure:
    figure = drawn()
    return Figure(name, figure.title, figure.caption, figure.png)


def assert_self_contained(html: str) -> Page:
    """Nothing is asked of elsewhere, and no script runs but the viewer, which the policy names by checksum."""
    page = Page(html)
    running = re.findall(r"<script>(.*?)</script>", html, re.S)
    assert len(running) == html.count("<script>") == ("scene-data" in html)
    policy = next(attributes["content"] for tag, attributes in page.tags if attributes.get("http-equiv"))
    named = {f"'sha256-{base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()}'" for script in running}
    assert set(re.findall(r"'sha256-[^']*'", policy)) == named
    assert page.open == []
    assert not {"link", "iframe", "object", "embed", "base", "form", "svg"} & {tag for tag, _ in page.tags}
    assert "src" not in {name for tag, attributes in page.tags if tag == "script" for name in attributes}
    for tag, attributes in page.tags:
        assert not [name for name in attributes if name.startswith("on")]
        for name in ("src", "href", "srcset", "action", "poster"):
            target = attributes.get(name)
            assert target is None or target.startswith(("#", "data:image/png;base64,")), (tag, target)
    style = re.search(r"<style>(.*?)</style>", html, re.S)
    assert style is not None
    assert "url(" not in style[1]
    assert "@import" not in style[1]
    return page


def test_the_summary_answers_first():
    page = assert_self_contained(render_html(nested_report(), [picture("one")]))
    head = page.text[: page.text.index("Figures")]
    for words in ("Simulation ready", "2 nested shells", "skin", "fat", "512", "98.62 %", "1.23 %", "0.998 mm"):
        assert words in head
    for words in ("Depth of the layers", "fat lies inside skin", "nodal movement", "doi:10.1000/1", "layers[0].depth_mm"):
        assert words in page.text
    assert "integument-server 0.1.0" in page.text
    assert "largest shift: 1.000e−06 mm" in page.text


def test_figures_are_embedded_with_captions_and_sizes():
    page = assert_self_contained(render_html(nested_report(), [picture("one"), picture("two")]))
    images = [attributes for tag, attributes in page.tags if tag == "img"]
    assert len(images) == 2
    assert all(int(image["width"]) > 500 and int(image["height"]) > 300 and image["alt"] for image in images)


def test_surfaces_in_3d_are_in_the_file_and_a_hostile_name_stays_text():
    scene = make_scene({"skin": sphere(30.0, 3), HOSTILE: sphere(29.0, 3)})
    html = render_html(nested_report(), [], scene)
    page = assert_self_contained(html)
    assert "2 surfaces, 1\u202f024 faces" in page.text
    about = re.search(r'<script type="application/json" id="scene-about">(.*?)</script>', html, re.S)
    assert about is not None
    assert json.loads(about[1]) == scene.about
    assert render_html(nested_report(), [], scene) == html


def test_a_missing_viewer_is_named_and_not_left_out(monkeypatch, tmp_path):
    report_viewer.cache_clear()
    monkeypatch.setattr(viewer, "FOLDER", tmp_path)
    with pytest.raises(InternalError) as caught:
        render_html(nested_report(), [], make_scene({"skin": sphere(30.0, 2)}))
    assert caught.value.code == "report.viewer_missing"
    assert "make web" in caught.value.message
    (tmp_path / "viewer.js").write_text("let page = '</SCRIPT>';")
    (tmp_path / "licenses.md").write_text("MIT")
    with pytest.raises(InternalError) as caught:
        render_html(nested_report(), [], make_scene({"skin": sphere(30.0, 2)}))
    assert caught.value.code == "report.viewer_unfit"
    report_viewer.cache_clear()


def test_hostile_names_and_messages_are_text_everywhere():
    validation = validate({HOSTILE: sphere(30.0, 2), "b": sphere(20.0, 2)})
    report = Report(
        process=HOSTILE,
        verdict="not_ready",
        summary=HOSTILE,
        meshes=validation.meshes,
        pairs=validation.pairs,
        nesting=validation.nesting,
        findings=(
            Finding(
                code="mesh.odd",
                severity=Severity.ERROR,
                message=f"first {HOSTILE}",
                count=1,
                places=(Place(mesh=HOSTILE, point_mm=(0, 0, 0), faces=(1,), vertices=(2,)),),
            ),
            Finding(code="mesh.odd", severity=Severity.ERROR, message=f"second {HOSTILE}", count=1),
        ),
        changes=({HOSTILE: HOSTILE},),
        methods=HOSTILE,
        references=(HOSTILE,),
        parameters={HOSTILE: {HOSTILE: [HOSTILE]}},
        software={HOSTILE: HOSTILE},
    )
    page = assert_self_contained(render_html(report, [Figure("x", HOSTILE, HOSTILE, picture("x").png)]))
    assert page.text.count(HOSTILE) >= 12
    assert "49" not in re.sub(r"[^{}0-9* ]", "", page.text).split()


def test_a_failed_report_says_why_and_where():
    broken = flipped(without_faces(sphere(30.0, 3), [0, 1, 7]), [20])
    validation = validate({"skin": broken})
    report = Report(
        process="shells",
        verdict="not_ready",
        summary="The skin is not closed.",
        meshes=validation.meshes,
        findings=validation.findings,
        parameters={"min_gap_mm": 0.05},
    )
    page = assert_self_contained(render_html(report, draw_mesh_figures({"skin": broken}, findings=validation.findings)))
    assert "Not ready" in page.text
    for finding in validation.findings:
        assert finding.message in page.text
        assert finding.code in page.text
    head = page.text[: page.text.index("Figures")]
    assert any(finding.message in head for finding in validation.findings)
    assert "Surface and places of the findings" in page.text


def test_a_failed_job_says_what_was_refused_in_its_headline():
    message = "at 514 of 26756 faces the skin is too thin for layer 'fat' (least room 0.2 mm); 'adapt' fades the depth there"
    failure = FailureReport(code="skin.too_thin", fault="input")
    page = assert_self_contained(render_html(Report(process="shells", verdict="not_ready", failure=failure, summary=message), []))
    assert "Refused: at 514 of 26\u202f756 faces the skin is too thin for layer 'fat'" in page.text
    assert "'adapt' fades the depth there" in page.text
    short = Report(process="shells", verdict="not_ready", failure=failure, summary="no two ears were found")
    assert assert_self_contained(render_html(short, [])).text.lower().count("no two ears were found") == 1


@pytest.mark.parametrize("verdict", ["simulation_ready", "not_ready"])
def test_a_report_that_knows_next_to_nothing_renders(verdict):
    page = assert_self_contained(render_html(Report(process="shells", verdict=verdict, summary="Nothing was made."), []))
    assert "Nothing was made." in page.text
    assert "None: every check passed" in page.text


@pytest.mark.parametrize(
    ("verdict", "words"), [("simulation_ready", "Every triangle has a value"), ("not_ready", "Triangles without a value")]
)
def test_a_map_of_a_field_is_not_called_simulation_ready(verdict, words):
    page = assert_self_contained(render_html(Report(process="fields", verdict=verdict, summary="One surface."), []))
    assert words in page.text
    assert "simulation ready" not in page.text[: page.text.index("One surface.")].lower()


def test_errors_come_before_warnings_and_links_hit_them():
    findings = tuple(
        Finding(code="mesh.odd", severity=severity, message=f"{severity.value} message", count=1)
        for severity in (Severity.INFO, Severity.ERROR, Severity.WARNING, Severity.ERROR)
    )
    page = Page(render_html(nested_report("not_ready", findings=findings), []))
    order = [attributes["class"] for tag, attributes in page.tags if tag == "article"]
    assert order == ["finding error", "finding error", "finding warning", "finding info"]
    targets = {attributes.get("id") for _, attributes in page.tags}
    links = [attributes["href"] for tag, attributes in page.tags if tag == "a"]
    assert len(links) == 2
    assert all(str(link)[1:] in targets for link in links)


def test_intersecting_pairs_stand_out():
    pair = PairReport(
        a="skin", b="fat", relation="intersecting", intersecting_pairs=7, case_1=1, case_2=2, case_3=4, min_gap_mm=0.0
    )
    html = render_html(nested_report("not_ready", pairs=(pair,)), [])
    bad = re.findall(r'<td class="bad">([^<]*)', html)
    assert bad.count("7") >= 3
    assert "0 mm" in bad


def test_same_report_same_bytes():
    assert render_html(nested_report(), [picture("one")]) == render_html(nested_report(), [picture("one")])


def test_contrast_of_text_is_readable_in_both_themes():
    """WCAG 2: 4.5 to 1 for ink and soft text on paper and panel."""
    css = re.search(r"<style>(.*?)</style>", render_html(nested_report(), []), re.S)
    assert css is not None
    for block in re.findall(r":root \{([^}]*)\}", css[1])[:2]:
        colours = dict(re.findall(r"--([a-z-]+): (#[0-9a-f]{3,6})", block))
        for text in ("ink", "soft", "bad", "good", "warn", "info", "link"):
            for ground in ("paper", "panel"):
                assert contrast(colours[text], colours[ground]) >= 4.5, (text, ground)


def contrast(first: str, second: str) -> float:
    def luminance(colour: str) -> float:
        digits = colour[1:] if len(colour) == 7 else "".join(2 * digit for digit in colour[1:])
        channels = np.array([int(digits[i : i + 2], 16) for i in (0, 2, 4)]) / 255
        linear = np.where(channels <= 0.04045, channels / 12.92, ((channels + 0.055) / 1.055) ** 2.4)
        return float(linear @ [0.2126, 0.7152, 0.0722])

    bright, dark = sorted((luminance(first), luminance(second)), reverse=True)
    return (bright + 0.05) / (dark + 0.05)
