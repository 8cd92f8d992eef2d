"""The notebooks run from their first cell to their last."""

import pytest
from conftest import ROOT

FOLDER = ROOT / "examples/notebooks"


@pytest.mark.parametrize("name", sorted(path.stem for path in FOLDER.glob("*.ipynb")))
def test_notebook_runs(name):
    nbformat, client = pytest.importorskip("nbformat"), pytest.importorskip("nbclient")
    for package in ("ipykernel", "matplotlib", "pandas", *(["pinocchio"] if "pinocchio" in name else [])):
        pytest.importorskip(package)
    notebook = nbformat.read(FOLDER / f"{name}.ipynb", as_version=4)
    client.NotebookClient(notebook, timeout=120, resources={"metadata": {"path": str(FOLDER)}}).execute()
    shown = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    assert any("image" in kind for output in shown for kind in output.get("data", {}))
