"""The end of every process page: its inputs and outputs as the server describes them."""

from __future__ import annotations

from core.schema.processes import PROCESSES, ProcessDescription
from scripts.handbook.schema_tables import named_in, property_table


def process_reference(process: ProcessDescription) -> str:
    """Markdown below the text of docs/processes/`process.id`.md; definitions by name, each with a table of its own."""
    schema = process.inputs.model_json_schema()
    definitions = schema.get("$defs", {})

    def link(name: str) -> str:
        return f"[{name}](#{anchor(process.id, name)})"

    parts = [
        "\n## Reference\n",
        f"Made from the schema of `{process.id}` {process.version} when this page was built; "
        f"`GET /v1/processes/{process.id}` answers with the same.\n",
        f"**{process.title}.** {process.description}\n",
        "### Inputs in full\n",
        property_table(schema, link, definitions),
    ]
    for name in named_in({key: value for key, value in schema.items() if key != "$defs"}, definitions):
        table = property_table(definitions[name], link, definitions)
        parts += [f"({anchor(process.id, name)})=\n### {name}\n", f"{definitions[name].get('description', '')}\n", table]
    parts += ["### Outputs\n", _outputs(process)]
    return "\n".join(parts)


def anchor(process: str, name: str) -> str:
    """The same definition is on several pages, so its page is in its label."""
    return f"{process}-{name.lower()}"


def pages() -> dict[str, str]:
    """File name below docs/processes -> what is added at its end."""
    return {f"{process.id}.md": process_reference(process) for process in PROCESSES.values()}


def _outputs(process: ProcessDescription) -> str:
    rows = [
        f"| `{name}` | {output.title} | `{output.media_type}` | {output.description} |"
        for name, output in process.outputs.items()
    ]
    if process.names_layers:
        rows.append("| `NAME` of each layer | Layer | `model/stl` | Every layer asked for, ready to be chained |")
    if process.names_surfaces:
        rows.append(
            "| `NAME` of each surface | Surface | `model/stl` | If several came: each under its own name, beside the package |"
        )
    return "\n".join(["| output | title | media type | what |", "|---|---|---|---|", *rows]) + "\n"
