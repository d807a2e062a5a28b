# SPDX-License-Identifier: GPL-3.0-or-later
"""write_stubs.py FOLDER: writes todbench/__init__.pyi beside the module in FOLDER, from its signatures and docstrings."""
import inspect
import re
import sys
from pathlib import Path

HEAD = '''# SPDX-License-Identifier: GPL-3.0-or-later
# Written by the build from the signatures of the module.
import os
import pathlib
from typing import Any, Callable, Dict, Iterator, List, Optional, Sequence, Tuple, Union, overload

import numpy

__version__: str
__commit__: str
__all__: List[str]
'''
SPELLINGS = (
    (r"todbench\.(?:_core\.)?", ""),
    (r"numpy\.ndarray\[[^\]]*\]", "numpy.ndarray"),
    (r"Annotated\[(.*?), FixedSize\(\d+\)\]", r"\1"),
    (r"List\[(\w+)\[\d+\]\]", r"List[\1]"),
    (r"(List\[\w+)\[\d+\]\]", r"\1]"),
    (r"(?<=: )(?:object|handle)\b|(?<=> )object\b", "Any"),
    (r"os\.PathLike", "Union[str, os.PathLike]"),
    (r"\*args\b", "*args: Any"),
    (r"\*\*kwargs\b", "**kwargs: Any"),
    (r"(?<=: )sequence\b", "Sequence[Any]"),
    (r"= <[^>]*>", "= ..."),
    (r"= PosixPath\([^)]*\)", "= ..."),
)


def spelled(text):
    for pattern, spelling in SPELLINGS:
        text = re.sub(pattern, spelling, text)
    return text


def docstring(text, indent):
    text = (text or "").strip().replace("\\", "\\\\").replace('"""', "'''")
    if not text:
        return ""
    if text.endswith('"'):
        text = text[:-1] + '\\"'
    lines = text.splitlines()
    return f'{indent}"""' + ("\n" + indent).join(lines) + ('"""\n' if len(lines) == 1 else f'\n{indent}"""\n')


def overloads(name, text):
    """(signature, docstring) of each overload, from the text that pybind11 writes."""
    text = text or ""
    if text.startswith(name + "(*args, **kwargs)\nOverloaded function."):
        parts = re.split(r"\n\d+\. (?=" + re.escape(name) + r"\()", text)[1:]
    else:
        parts = [text]
    for part in parts:
        signature, _, rest = part.partition("\n")
        yield signature.strip(), rest.strip()


def function(name, text, indent):
    found = list(overloads(name, text))
    written = ""
    for signature, words in found:
        if not signature.startswith(name + "("):
            sys.exit(f"no signature of {name}: {signature}")
        if len(found) > 1:
            written += f"{indent}@overload\n"
        written += f"{indent}def {spelled(signature)}:\n"
        written += docstring(words, indent + "    ") + f"{indent}    ...\n"
    return written


def class_stub(name, kind):
    base = "" if kind.__base__.__name__ == "pybind11_object" else f"({kind.__base__.__name__})"
    written = f"class {name}{base}:\n" + docstring(kind.__doc__, "    ")
    if issubclass(kind, Exception):
        return written + "    code: str\n    key: Optional[str]\n    reason: str\n"
    body = ""
    for member, value in sorted(vars(kind).items()):
        if isinstance(value, property):
            result = (value.fget.__doc__ or "").partition("->")[2].strip().splitlines()
            returned = spelled(result[0]) if result else "Any"
            body += f"    @property\n    def {member}(self) -> {returned}:\n" + docstring(value.__doc__, "        ")
            body += "        ...\n"
            if value.fset:
                body += f"    @{member}.setter\n    def {member}(self, value: Any) -> None: ...\n"
        elif member.startswith("__") and member not in ("__init__", "__iter__", "__next__", "__enter__", "__exit__",
                                                        "__getitem__"):
            continue
        elif isinstance(value, staticmethod):
            body += "    @staticmethod\n" + function(member, value.__func__.__doc__, "    ")
        elif callable(value) and value.__doc__ and value.__doc__.startswith(member + "("):
            body += function(member, value.__doc__, "    ")
    return written + (body or "    ...\n")


def main():
    folder = Path(sys.argv[1])
    sys.path.insert(0, str(folder))
    import todbench

    written = HEAD
    for name in todbench.__all__:
        value = getattr(todbench, name)
        written += "\n\n"
        if inspect.isclass(value):
            written += class_stub(name, value)
        else:
            written += function(name, value.__doc__, "")
    compile(written, "__init__.pyi", "exec")
    (folder / "todbench" / "__init__.pyi").write_text(written)


if __name__ == "__main__":
    main()
