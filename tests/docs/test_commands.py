"""What the pages say of the command exists: every option that stands behind `contin NAME`."""

import re
from pathlib import Path

from typer.main import get_command

from contin.cli.main import app

ROOT = Path(__file__).parents[2]
PAGES = [*(ROOT / "docs").rglob("*.md"), ROOT / "README.md"]
COMMANDS = {
    name: {"--help", "-h"} | {option for p in command.params for option in (*p.opts, *p.secondary_opts)}
    for name, command in get_command(app).commands.items()
}


def options_of(line):
    """(command, option) of each command on a line, up to where its code ends."""
    for match in re.finditer(r"contin ([a-z]+)\b([^`|;\n]*)", line):
        if match.group(1) in COMMANDS:
            for option in re.findall(r"(?<![\w-])(--[a-z][a-z-]*|-[a-z])\b", match.group(2)):
                yield match.group(1), option


def test_options_that_the_pages_name_exist():
    lines = [(page.name, line) for page in PAGES for line in page.read_text().splitlines()]
    named = [(page, *found) for page, line in lines for found in options_of(line)]
    assert len(named) > 30
    assert not [(page, command, option) for page, command, option in named if option not in COMMANDS[command]]
