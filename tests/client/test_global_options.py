import pytest
from integument.cli.global_options import split_global


@pytest.mark.parametrize(
    ("line", "found", "rest"),
    [
        ("shells skin.stl --json", "--json", "shells skin.stl"),
        ("shells --server http://a skin.stl -q", "--server http://a -q", "shells skin.stl"),
        ("jobs --server=http://a --limit 3", "--server=http://a", "jobs --limit 3"),
        ("shells -- --json", "", "shells -- --json"),
        ("jobs --server", "--server", "jobs"),
        ("", "", ""),
    ],
)
def test_global_options_are_found_anywhere(line: str, found: str, rest: str) -> None:
    assert split_global(line.split()) == (found.split(), rest.split())
