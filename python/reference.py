"""Makes the reference of the Python package, docs/generated/python-api.md, of its signatures and docstrings.

``python python/reference.py`` writes it; a test compares it.
"""

from __future__ import annotations

import re
from pathlib import Path
from textwrap import dedent

import griffe

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "generated" / "python-api.md"

#: Modules, each with the heading of its part.
MODULES = {"crepitus": "crepitus", "crepitus.experiments": "crepitus.experiments"}

#: The section of a docstring that says what is returned.
RETURNS = re.compile(r"^Returns:\n((?:    .*\n|\n)+)", re.MULTILINE)

#: Most characters of a signature on one line.
WIDTH = 100


def text() -> str:
    """The page."""
    package = griffe.load(
        "crepitus",
        search_paths=[str(ROOT / "python" / "package")],
        docstring_parser="google",
        allow_inspection=False,
        resolve_aliases=True,
    )
    lines = [
        "<!-- Made by python/reference.py of the package's signatures and docstrings. -->",
        "# Reference of the Python package",
        "",
        "[The page on Python](../python.md) leads through it by examples.",
        "",
    ]
    for name, title in MODULES.items():
        module = package if name == "crepitus" else package[name.removeprefix("crepitus.")]
        lines += [f"## `{title}`", "", *_docstring(module), ""]
        for public in sorted(_public(module), key=str.lower):
            if name != "crepitus" or public != "experiments":
                lines += _member(module, public)
    page = "\n".join(lines)
    return re.sub(r"\n{3,}", "\n\n", page).rstrip() + "\n"


def _public(module: griffe.Object | griffe.Alias) -> list[str]:
    return [str(name) for name in module.exports or []]


def _member(module: griffe.Object | griffe.Alias, name: str) -> list[str]:
    thing = module[name]
    if isinstance(thing, griffe.Alias):
        thing = thing.final_target
    if isinstance(thing, griffe.Class):
        return _class(thing, name)
    if isinstance(thing, griffe.Function):
        return [f"### {name}", "", *_signature(thing, name), *_docstring(thing), ""]
    lines = [f"### {name}", ""]
    if isinstance(thing, griffe.Attribute) and thing.annotation is not None:
        lines += [f"`{name}: {thing.annotation}`", ""]
    return lines + [*_docstring(thing), ""]


def _class(thing: griffe.Class, name: str) -> list[str]:
    bases = [str(base) for base in thing.bases]
    of = f"({', '.join(bases)})" if bases else ""
    lines = [f"### {name}", "", f"`class {name}{of}`", "", *_docstring(thing), ""]
    maker = thing.members.get("__init__") or thing.members.get("__new__")
    if isinstance(maker, griffe.Function):
        lines += [*_signature(maker, name), *_docstring(maker), ""]
    for member_name, member in thing.members.items():
        if member_name.startswith("_"):
            continue
        if isinstance(member, griffe.Function):
            lines += [f"#### {name}.{member_name}", "", *_signature(member, member_name), *_docstring(member), ""]
        elif isinstance(member, griffe.Attribute) and "property" in member.labels:
            lines += [f"#### {name}.{member_name}", "", f"`{member_name}: {member.annotation}`", ""]
            lines += [*_docstring(member), ""]
    return lines


def _signature(function: griffe.Function, name: str) -> list[str]:
    """The call with types, in a block; a parameter a line if it is long."""
    words, is_keyword = [], False
    for parameter in function.parameters:
        if parameter.name in ("self", "cls"):
            continue
        kind = parameter.kind
        if kind is griffe.ParameterKind.keyword_only and not is_keyword:
            words.append("*")
            is_keyword = True
        stars = {griffe.ParameterKind.var_positional: "*", griffe.ParameterKind.var_keyword: "**"}.get(kind, "")
        is_keyword |= stars == "*"
        word = stars + parameter.name
        if parameter.annotation is not None:
            word += f": {parameter.annotation}"
        if parameter.default is not None and not stars:
            word += f" = {parameter.default}" if parameter.annotation is not None else f"={parameter.default}"
        words.append(word)
    returns = f" -> {function.returns}" if function.returns is not None and name == function.name else ""
    line = f"{name}({', '.join(words)}){returns}"
    if len(line) > WIDTH:
        line = f"{name}(\n" + "".join(f"    {word},\n" for word in words) + f"){returns}"
    return ["```python", line, "```", ""]


def _docstring(thing: griffe.Object | griffe.Alias) -> list[str]:
    if thing.docstring is None:
        return []
    lines: list[str] = []
    for section in thing.docstring.parse("google", warnings=False):
        if section.kind is griffe.DocstringSectionKind.text:
            lines += [_words(str(section.value)), ""]
        elif section.kind is griffe.DocstringSectionKind.examples:
            for _, example in section.value:
                lines += ["```python", str(example), "```", ""]
        elif section.kind is griffe.DocstringSectionKind.admonition:
            lines += [f"**{section.title}**: {_words(str(section.value.description))}", ""]
        elif section.kind is griffe.DocstringSectionKind.returns:
            # The parser takes a sentence with a colon for a name.
            returned = RETURNS.search(thing.docstring.value + "\n")
            lines += ["**Returns**", "", _words(dedent(returned.group(1)) if returned else "").strip(), ""]
        else:
            lines += [f"**{section.kind.value.capitalize()}**", ""]
            for item in section.value:
                named = getattr(item, "name", "") or ""
                if section.kind is griffe.DocstringSectionKind.raises:
                    named = str(item.annotation)
                before = f"`{named}`: " if named else ""
                lines.append(f"- {before}{_words(item.description, joined=True)}")
            lines.append("")
    return lines


def _words(text: str, joined: bool = False) -> str:
    """Text of a docstring as Markdown: roles and double backquotes as code, examples and tables as blocks."""
    if joined:
        text = " ".join(text.split())
    text = re.sub(r":(?:func|class|meth|mod|attr):`~?([^`]*)`", r"`\1`", text)
    text = text.replace("``", "`")
    lines: list[str] = []
    width, is_code = 0, False
    for line in text.splitlines():
        if line.startswith("==="):
            # A table of reStructuredText: its first line, or its last.
            if not width:
                lines += ["| for | there is |", "|---|---|"]
            width = 0 if width else line.index(" ")
        elif width:
            first, second = line[:width].strip(), line[width:].strip()
            if first:
                lines.append(f"| {first} | {second} |")
            else:
                lines[-1] = f"{lines[-1].removesuffix(' |')} {second} |"
        else:
            was_code, is_code = is_code, line.startswith((">>>", "..."))
            is_code |= was_code and line.strip() != ""
            if is_code != was_code:
                lines.append("```python" if is_code else "```")
            lines.append(line)
    return "\n".join([*lines, "```"] if is_code else lines)


if __name__ == "__main__":
    PAGE.write_text(text(), encoding="utf-8")
