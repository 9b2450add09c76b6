"""Writes the reference page of the package from its docstrings: `python python/tests/reference.py > docs/guide/reference/python.md`."""

import inspect
import re

import scaleproof


def signature(name, what):
    text = str(inspect.signature(what)).replace("'", "")
    return f"`{name}{text}`".replace("scaleproof.locating.", "").replace("scaleproof._process.", "").replace("numpy.typing.", "")


def prose(what):
    text = inspect.getdoc(what) or ""
    return text.replace("``", "`").replace(":class:", "").replace(":func:", "").replace(":meth:", "").replace(":attr:", "")


def fields(kind):
    """Fields and attributes of a class, each with the lines behind `#:` above it."""
    about = []
    for line in inspect.getsource(kind).splitlines():
        line = line.strip()
        found = re.match(r"(?:self\.)?([a-z]\w*): ([^=]*[^= ])", line)
        if line.startswith("#: "):
            about.append(line[3:])
        elif found and not line.endswith(":"):
            name, of = found.groups()
            text = " ".join(about).replace(":attr:", "").replace("``", "`")
            of = of.replace("numpy.typing.", "").replace(" = field(repr=False)", "")
            yield f"- `{name}: {of}`" + (f": {text}" if text else "")
            about = []
        else:
            about = []


def members(kind):
    for name, what in vars(kind).items():
        if name.startswith("_") or isinstance(what, (int, str, type(None))):
            continue
        if isinstance(what, property):
            yield f"- `{name}`: {prose(what)}"
        elif isinstance(what, (classmethod, staticmethod)) or callable(what):
            yield f"- {signature(name, getattr(kind, name))}: {prose(what)}"


print("# Python\n\nEvery name of the module `scaleproof`; written from its docstrings by `python/tests/reference.py`.")
for name in scaleproof.__all__:
    what = getattr(scaleproof, name)
    if isinstance(what, str) or not (inspect.isclass(what) or inspect.isfunction(what)):
        continue
    if name == "Error":
        print(f"\n## {name}\n\n{prose(what)}")
        continue
    print(f"\n## {name}\n\n{signature(name, what)}\n\n{prose(what)}")
    if inspect.isclass(what):
        inherited = what.__mro__[1] if what.__mro__[1].__name__ == "_Report" else None
        both = [what, *([inherited] if inherited else [])]
        listed = [line for kind in both for line in (*fields(kind), *members(kind))]
        if listed:
            print("\n" + "\n".join(line.replace("\n\n", " ").replace("\n", " ") for line in listed))
