"""The documentation site as `make docs` builds it: which files there are, and what each of its pages may do."""

from __future__ import annotations

import base64
import hashlib
import re
from collections.abc import Mapping
from functools import cache
from pathlib import Path

from api.page_files import INDEX, MEDIA_TYPES, PageFile

FOLDER = Path(__file__).resolve().parent / "handbook"
SCRIPT = re.compile(rb"<script(?![^>]*\ssrc=)[^>]*>(.*?)</script>", re.DOTALL)
# scripts of its own and those that stand in the page itself, by checksum; the theme's icons have styles of their own
POLICY = (
    "default-src 'none'; script-src 'self'{inline}; style-src 'self' 'unsafe-inline'; img-src 'self' data:; connect-src 'self'; "
    "frame-ancestors 'none'; base-uri 'none'; form-action 'self'"
)


@cache
def find_handbook(folder: Path = FOLDER) -> Mapping[str, Path]:
    """Path below the site's root -> file; `` and a folder's own path are its index. Empty if the site was not built."""
    found = {path.relative_to(folder).as_posix(): path for path in sorted(folder.rglob("*")) if path.suffix in MEDIA_TYPES}
    return found | {name.removesuffix(INDEX): path for name, path in found.items() if path.name == INDEX}


@cache
def read_handbook_file(path: Path) -> tuple[PageFile, str]:
    """The file and the policy it is sent with; the whole site is a few megabytes."""
    file = PageFile.read(path)
    scripts = SCRIPT.findall(file.content) if path.suffix == ".html" else []
    sums = dict.fromkeys(base64.b64encode(hashlib.sha256(script).digest()).decode() for script in scripts)
    return file, POLICY.format(inline="".join(f" 'sha256-{sum_}'" for sum_ in sums))
