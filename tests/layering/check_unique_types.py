# SPDX-License-Identifier: GPL-3.0-or-later
"""Every type of the product has a name of its own: two definitions of one name in one namespace are a violation, because a program
that includes both headers does not compile, and one that links both may mix up their inline functions.

Usage: check_unique_types.py ROOT. Prints each violation with its files; exit code 1 if there is one.
"""
import collections
import pathlib
import re
import sys

# A namespace, a type with its body, any other brace, in the order in which they stand.
TOKEN = re.compile(
    r"(?P<namespace>\bnamespace\b(?P<name>[\s\w:]*)\{)"
    r"|(?P<type>\b(?:struct|class|union|enum(?:\s+(?:class|struct))?)\s+(?:\[\[\w+\]\]\s+)?(?P<named>\w+)(?P<rest>[^;{}()]*)\{)"
    r"|(?P<open>\{)|(?P<close>\})")


def without_comments(text):
    text = re.sub(r'R"(\w*)\((.*?)\)\1"', '""', text, flags=re.S)
    return re.sub(r"//[^\n]*|/\*.*?\*/|\"(?:\\.|[^\"\\\n])*\"|'(?:\\.|[^'\\\n])'", " ", text, flags=re.S)


def types_of(text):
    """Names of the types that a file defines at namespace scope, outside unnamed namespaces."""
    scopes = []
    for token in TOKEN.finditer(without_comments(text)):
        if token["namespace"]:
            scopes.append(token["name"].strip() or None)
        elif token["close"]:
            if scopes:
                scopes.pop()
        else:
            outside = all(isinstance(scope, str) for scope in scopes)
            if token["type"] and outside and not token["rest"].lstrip().startswith(("::", "<")):
                yield "::".join(scopes + [token["named"]])
            scopes.append(False)


def main(root):
    places = collections.defaultdict(list)
    for folder in ("acquisition", "hvs", "tod", "sim_devices", "bench"):
        for path in sorted((root / folder).rglob("*")):
            if path.suffix in (".h", ".cpp"):
                for name in types_of(path.read_text(encoding="utf-8")):
                    places[name].append(str(path.relative_to(root)))
    bad = {name: files for name, files in places.items() if len(files) > 1}
    for name, files in sorted(bad.items()):
        print(f"{name} is defined in {', '.join(files)}")
    return 1 if bad or not places else 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1])))
