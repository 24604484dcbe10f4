# SPDX-License-Identifier: BSD-3-Clause
"""Writes type stubs (.pyi) of extension modules from the signatures that pybind11 puts into their docstrings.

make_stubs.py FOLDER MODULE...: FOLDER/stillpoint/MODULE.pyi for each module of the package in FOLDER.
"""

import importlib
import re
import sys
from pathlib import Path

OVERLOAD = re.compile(r"^\d+\. ")
SPECIAL = ("__init__", "__len__", "__mul__", "__iter__", "__next__", "__getitem__", "__enter__")
ARRAY = re.compile(r"numpy\.ndarray(\[numpy\.(\w+)\])?")


def types_of(signature, module):
    """The signature with types as type checkers know them."""
    arguments, arrow, result = signature.rpartition(" -> ")
    arguments = ARRAY.sub("numpy.typing.ArrayLike", arguments)
    result = ARRAY.sub(lambda m: f"numpy.typing.NDArray[numpy.{m[2]}]" if m[2] else "numpy.typing.NDArray", result)
    signature = arguments + arrow + result
    signature = re.sub(r"os\.PathLike", "str | os.PathLike[str]", signature)
    signature = re.sub(r"= <.*?>(?=, \w+:|\) ->)", "= ...", signature)
    return signature.replace(module + ".", "").replace("stillpoint._eval.", "_eval.")


def signatures(function, name, module):
    """(signature, text) of each overload."""
    lines = (function.__doc__ or "").strip().splitlines()
    if not lines:
        return [(f"{name}(*args, **kwargs)", "")]
    if not (len(lines) > 1 and lines[1].startswith("Overloaded")) and "Overloaded function." not in lines:
        return [(types_of(lines[0], module), " ".join(line.strip() for line in lines[1:] if line.strip()))]
    found = []
    for line in lines:
        if OVERLOAD.match(line):
            found.append([types_of(OVERLOAD.sub("", line), module), ""])
        elif found and line.strip():
            found[-1][1] += (" " if found[-1][1] else "") + line.strip()
    return found


def function_lines(function, name, module, indent="", static=False):
    """Of a function, or with an indent of a method."""
    lines = []
    overloads = signatures(function, name, module)
    for signature, text in overloads:
        if len(overloads) > 1:
            lines.append(f"{indent}@typing.overload")
        if static:
            lines.append(f"{indent}@staticmethod")
        elif indent:
            signature = re.sub(r"\((self|arg0)(: [\w.]+)?", "(self", signature)
        lines.append(f"{indent}def {signature}:")
        lines += [f'{indent}    """{text}"""'] if text else []
        lines.append(f"{indent}    ...")
    return lines


def property_lines(value, name, module):
    signature = types_of((value.fget.__doc__ or "").strip().splitlines()[0], module)
    lines = ["    @property", f"    def {name}(self) -> {signature.split(' -> ')[-1]}:"]
    lines += [f'        """{value.__doc__.strip()}"""'] if value.__doc__ else []
    lines.append("        ...")
    if value.fset:
        lines += [f"    @{name}.setter", f"    def {name}(self, value) -> None: ..."]
    return lines


def class_lines(kind, module):
    base = "(ValueError)" if issubclass(kind, ValueError) else ""
    lines = [f"class {kind.__name__}{base}:", f'    """{(kind.__doc__ or "").strip()}"""']
    for name, value in vars(kind).items():
        if isinstance(value, property):
            lines += property_lines(value, name, module)
        elif name == "__init__" and not value.__doc__.startswith("__init__"):
            continue  # made by functions only
        elif name in SPECIAL or (not name.startswith("_") and callable(getattr(kind, name))):
            lines += function_lines(getattr(kind, name), name, module, "    ", isinstance(value, staticmethod))
    return lines + [""]


def stub(module):
    lines = ['"""' + (module.__doc__ or "").strip() + '"""', "", "from __future__ import annotations", ""]
    lines += ["import os", "import typing", "import numpy", "import numpy.typing", "from typing import *", ""]
    if module.__name__ != "stillpoint._eval":
        lines += ["from . import _eval", ""]
    for name, value in sorted(vars(module).items()):
        if name.startswith("_"):
            continue
        if isinstance(value, type):
            lines += class_lines(value, module.__name__)
        elif callable(value):
            lines += function_lines(value, name, module.__name__) + [""]
    return "\n".join(lines).rstrip() + "\n"


def main():
    folder = Path(sys.argv[1])
    sys.path.insert(0, str(folder))
    for name in sys.argv[2:]:
        path = folder / "stillpoint" / f"{name}.pyi"
        text = stub(importlib.import_module(f"stillpoint.{name}"))
        if not path.exists() or path.read_text() != text:
            path.write_text(text)


if __name__ == "__main__":
    main()
