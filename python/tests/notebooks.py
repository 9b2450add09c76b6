"""Runs a notebook in a kernel of Jupyter and prints it as a page of the guide, with what its cells print:

python python/tests/notebooks.py own_loss > docs/guide/notebooks/own_loss.md
"""

import re
import sys
from pathlib import Path

import nbclient
import nbformat

FOLDER = Path(__file__).parents[1] / "notebooks"
ABOUT = "<!-- Written by python/tests/notebooks.py. -->"


def cells(text):
    """The cells of a file in the percent format, which editors and Jupytext open as a notebook."""
    for part in re.split(r"^# %%", text, flags=re.MULTILINE)[1:]:
        kind, body = part.split("\n", 1)
        if "[markdown]" in kind:
            yield nbformat.v4.new_markdown_cell(re.sub(r"^# ?", "", body.strip(), flags=re.MULTILINE))
        else:
            yield nbformat.v4.new_code_cell(body.strip())


def outputs(cell):
    for one in cell.outputs:
        if one.output_type == "stream":
            assert one.name == "stdout", one.text
            yield one.text.rstrip()
        else:
            yield one.data["text/plain"]


def page(name):
    notebook = nbformat.v4.new_notebook(cells=list(cells((FOLDER / f"{name}.py").read_text())))
    nbclient.NotebookClient(notebook, timeout=120, coalesce_streams=True, kernel_name="python3", resources={"metadata": {"path": str(FOLDER)}}).execute()
    title, *rest = notebook.cells
    parts = [title.source, f"{ABOUT}\n\nA notebook: `python/notebooks/{name}.py`."]
    for cell in rest:
        if cell.cell_type == "markdown":
            parts.append(cell.source)
            continue
        parts.append(f"```python\n{cell.source}\n```")
        if printed := "\n".join(outputs(cell)):
            parts.append(f"```text\n{printed}\n```")
    return "\n\n".join(parts) + "\n"


if __name__ == "__main__":
    print(page(sys.argv[1]), end="")
