"""The pages' templates: what is put in is text, and the words of numbers are the same on all of them."""

from __future__ import annotations

from functools import cache

from jinja2 import Environment, PackageLoader, StrictUndefined, Template

from core.reports import prose, wording
from core.reports.citations import in_order_of_citation
from core.reports.facts import heading


def template(name: str) -> Template:
    """A file of `core/reports/templates`, compiled once per process."""
    return _environment().get_template(name)


@cache
def _environment() -> Environment:
    environment = Environment(
        loader=PackageLoader("core.reports", "templates"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        auto_reload=False,  # of one version with the code that is loaded, also while a server is being upgraded
    )
    for word in (
        "whole",
        "significant",
        "area",
        "volume",
        "drift",
        "percent",
        "yes_no",
        "point",
        "numbers",
        "relation",
        "flattened",
        "outcome",
        "quantity",
        "spot",
        "distance",
        "depth",
        "title_of",
    ):
        environment.filters[word] = getattr(wording, word)
    environment.filters["sentence"] = prose.sentence
    environment.filters["grouped"] = prose.grouped
    environment.filters["heading"] = heading
    environment.filters["cited"] = in_order_of_citation
    return environment
