"""Build the documentation site into api/handbook, where the server takes it from; a link that leads nowhere is an error.

Pages come from docs/, reference tables from the process schemas and openapi/.

Nothing is fetched, and the pages fetch nothing: fonts are the reader's, scripts and styles lie in the folder.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))

from scripts.handbook.stage import SITE, stage  # noqa: E402, as a program this file's folder is the path, not the tree's root

OUT = ROOT / "api" / "handbook"


def build(pages: Path, out: Path) -> subprocess.CompletedProcess[str]:
    """Run Sphinx over staged pages; what it warns of makes it fail, and is in `stderr`."""
    with tempfile.TemporaryDirectory() as folder:
        return subprocess.run(
            [
                *(sys.executable, "-m", "sphinx", "--builder", "html", "--fail-on-warning", "--nitpicky", "--quiet"),
                *("--conf-dir", str(ROOT / SITE), "--doctree-dir", folder, "--fresh-env", str(pages), str(out)),
            ],
            cwd=folder,
            capture_output=True,
            text=True,
        )


def main() -> int:
    """0 built, 1 something is wrong with a page."""
    out = Path(sys.argv[1]).resolve() if len(sys.argv) > 1 else OUT
    with tempfile.TemporaryDirectory() as folder:
        stage(Path(folder))
        done = build(Path(folder), out)
        print(done.stderr.replace(f"{folder}/", ""), end="", file=sys.stderr)
    if done.returncode == 0:
        print(f"{out / 'index.html'}")
    return done.returncode


if __name__ == "__main__":
    sys.exit(main())
