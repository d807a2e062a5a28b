# SPDX-License-Identifier: GPL-3.0-or-later
"""write_comments.py HEADERS OUTPUT UNIT...: comments of declarations as a C++ table for doc().

HEADERS lists the headers, one a line. Only declarations that the units name are written. A declaration without a comment that a unit names is an
error, so that no part of the module is without a docstring.
"""
import re
import sys
from pathlib import Path

COMMENT = re.compile(r"^\s*///<?\s?(.*)$")
TRAILING = re.compile(r"^(.*?)\s*///<\s?(.*)$")
SCOPE = re.compile(r"\b(?:struct|class|enum class|namespace)\s+(?:\[\[\w+\]\]\s*)?([\w:]+)?(?:\s+final)?\s*(?::[^{;]*)?\{")


def declared(statement):
    """Names that a statement declares: of a function, an alias, or one or more members."""
    statement = re.sub(r"\[\[\w+\]\]|\b(?:virtual|static|explicit|inline|constexpr|const|mutable)\b", " ", statement)
    statement = re.sub(r"\{[^{}]*\}|=[^;,]*", "", statement)
    while re.search(r"<[^<>]*>", statement):
        statement = re.sub(r"<[^<>]*>", "", statement)
    function = re.search(r"(\w+)\s*\(", statement)
    if function:
        return [function.group(1)]
    return [name for name in (re.search(r"(\w+)\s*$", part.strip(" ;")) for part in statement.split(",")) if name
            for name in [name.group(1)]]


def comments_of(text):
    """{"Type::member" or "function": comment} of one header."""
    found, scopes, pending, statement = {}, [], [], ""

    def note(name, lines):
        scope = [one for one in scopes if one and one != "todbench"]
        full = "::".join(scope + [name])
        if lines and full not in found:
            found[full] = "\n".join(lines).strip()

    for line in text.splitlines():
        if line.lstrip().startswith("#") or not line.strip():
            if not line.strip():
                pending = []
            continue
        comment = COMMENT.match(line)
        if comment:
            pending.append(comment.group(1))
            continue
        trailing = TRAILING.match(line)
        own = [trailing.group(2)] if trailing else []
        code = re.sub(r"//.*$", "", trailing.group(1) if trailing else line)
        statement += " " + code.strip()
        scope = SCOPE.search(statement)
        opened, closed = statement.count("{"), statement.count("}")
        if scope and opened > closed:
            name = scope.group(1) or ""
            if "namespace" not in statement.split("{")[0]:
                note(name, pending)
            scopes.append(name)
            pending, statement = [], ""
        elif opened > closed:
            if "(" in statement.split("{")[0] and not statement.split("{")[0].rstrip().endswith("="):
                for name in declared(statement.split("{")[0]):
                    note(name, pending + own)
                pending, statement = [], ""
                scopes.append("")
        elif closed > opened:
            if scopes:
                scopes.pop()
            pending, statement = [], ""
        elif statement.rstrip().endswith((";", "}", ",")) and statement.count("(") == statement.count(")"):
            if not statement.rstrip().endswith(",") or "(" not in statement:
                for name in declared(statement):
                    note(name, pending + own)
            pending, statement = [], ""
    return found


def main():
    headers, output, units = Path(sys.argv[1]), Path(sys.argv[2]), [Path(unit) for unit in sys.argv[3:]]
    wanted = set()
    for unit in units:
        text = unit.read_text()
        wanted.update(re.findall(r'\bdoc\("([\w:]+)"\)', text))
        wanted.update("::".join(pair) for pair in re.findall(r"TODBENCH_(?:READ|WRITE)\((\w+), (\w+)\)", text))
    found = {}
    for header in headers.read_text().split():
        for name, comment in comments_of(Path(header).read_text()).items():
            found.setdefault(name, comment)
    missing = sorted(name for name in wanted if not found.get(name))
    if missing:
        sys.exit("no comment in the headers: " + ", ".join(missing))
    rows = "".join('    {"%s", R"~(%s)~"},\n' % (name, found[name]) for name in sorted(wanted))
    output.write_text(f"""#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

namespace todbench {{

const char* doc(std::string_view name);

namespace {{
constexpr std::array<std::pair<std::string_view, const char*>, {len(wanted)}> comments{{{{
{rows}}}}};
}}  // namespace

const char* doc(std::string_view name) {{
  const auto at = std::lower_bound(comments.begin(), comments.end(), name,
                                   [](const auto& row, std::string_view wanted) {{ return row.first < wanted; }});
  return at != comments.end() && at->first == name ? at->second : "";
}}

}}  // namespace todbench
""")


if __name__ == "__main__":
    main()
