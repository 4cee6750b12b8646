"""Blocks that nobody can run here (Docker, a cluster, programs that never end): their commands parse, and name what exists."""

from __future__ import annotations

import re
import shlex
import subprocess
import tempfile
from collections.abc import Iterator
from pathlib import Path

import click
from integument.cli.global_options import split_global
from integument.cli.main import app
from typer.main import get_command

from server.admin.command import _parser as admin_parser
from tests.docs.blocks import Block
from tests.project.sources import ROOT

ELSEWHERE = {"docker", "kubectl", "cp", "printf", "curl", "pip", "chmod", "openssl", "export"}
"""Programs that are not ours."""


def complaints(block: Block) -> list[str]:
    """What is wrong with it."""
    if block.language == "matlab":
        return _misread_by_octave(block.text)
    if block.language == "json":  # `test_requests_are_accepted` sends it
        return []
    script = block.commands()
    parsed = subprocess.run(["bash", "-n"], input=script, capture_output=True, text=True)
    return [*([parsed.stderr] if parsed.returncode else []), *(told for words in _commands(script) for told in _wrong(words))]


def _misread_by_octave(text: str) -> list[str]:
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "block.m").write_text(text, encoding="utf-8")
        words = ["octave-cli", "--quiet", "--eval", f"__parse_file__('{folder}/block.m')"]
        parsed = subprocess.run(words, capture_output=True, text=True)
    return [parsed.stderr] if parsed.returncode or "parse error" in parsed.stderr else []


def _commands(script: str) -> Iterator[list[str]]:
    for line in script.replace("\\\n", " ").splitlines():
        lexer = shlex.shlex(line, posix=True, punctuation_chars="|&;<>()")
        lexer.whitespace_split = True
        words: list[str] = []
        for word in [*lexer, ";"]:
            if set(word) <= set("|&;"):
                if words:
                    yield words
                words = []
            else:
                words.append(word)


def _wrong(words: list[str]) -> Iterator[str]:
    while words and re.match(r"\w+=", words[0]):
        words = words[1:]
    if not words or words[0] in ELSEWHERE:
        return
    program, *rest = words
    if program == "integument":
        yield from _wrong_command(rest)
    elif program == "make":
        targets = re.findall(r"^([a-z]+):", (ROOT / "Makefile").read_text(), flags=re.MULTILINE)
        yield from (f"make has no {word}" for word in rest if "=" not in word and word not in targets)
    elif program.endswith("python"):
        path = rest[1].replace(".", "/") if rest[0] == "-m" else rest[0]
        if not any((ROOT / name).exists() for name in (path, f"{path}.py", f"{path}/__main__.py")):
            yield f"{path} does not exist"
    elif not program.startswith(".venv/bin/"):
        yield f"{program} is nothing these pages speak of"


def _wrong_command(words: list[str]) -> Iterator[str]:
    if words[0] == "admin":
        try:
            admin_parser().parse_args(words[1:])
        except SystemExit:
            yield f"integument {shlex.join(words)}: not understood"
        return
    group = get_command(app)
    found, rest = split_global(words)
    try:
        with group.make_context("integument", [*found, *rest]) as context:
            name, command, arguments = group.resolve_command(context, [*context._protected_args, *context.args])
            if command is None:
                yield f"there is no integument {name}"
            else:
                command.make_context(name, arguments, parent=context)
    except click.ClickException as error:
        yield f"integument {shlex.join(words)}: {error.format_message()}"
