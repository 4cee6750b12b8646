"""docs/cli.md names every command and every option, and none that is not there."""

import re
from pathlib import Path

from integument.cli.main import app
from typer.main import get_command

DOCS = (Path(__file__).resolve().parents[2] / "docs" / "cli.md").read_text(encoding="utf-8")


def options() -> set[str]:
    group = get_command(app)
    params = [*group.params, *(param for command in group.commands.values() for param in command.params)]
    shown = [param for param in params if not getattr(param, "hidden", False)]
    return {name for param in shown for name in (*param.opts, *param.secondary_opts) if name.startswith("-")}


def test_every_command_is_documented() -> None:
    documented = set(re.findall(r"`integument (\w+)", DOCS))
    assert documented == set(get_command(app).commands)


def test_every_option_is_documented() -> None:
    before, _, admin = DOCS.partition("\n## `integument admin`")  # those commands are the server's, held in tests/server
    documented = set(re.findall(r"`(--?[a-z][a-z-]*)", before + admin.partition("\n## ")[2]))
    assert documented - {"--help"} == options()
