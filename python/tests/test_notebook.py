"""The notebooks of the documentation run from top to bottom, and say what their texts say."""

from pathlib import Path

import pytest

nbformat, nbclient = pytest.importorskip("nbformat"), pytest.importorskip("nbclient")
pytest.importorskip("ipykernel")
NOTEBOOKS = Path(__file__).parents[2] / "docs/notebooks"


@pytest.mark.filterwarnings("default")
def test_law_from_a_table_to_a_verdict():
    notebook = nbformat.read(NOTEBOOKS / "table-to-verdict.ipynb", as_version=4)
    assert all(not cell.get("outputs") for cell in notebook.cells), "stored without outputs"
    nbclient.NotebookClient(notebook, timeout=300, kernel_name="python3").execute()
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", ())]
    shown = [output["data"] for output in outputs if "data" in output]
    assert any("image/png" in data for data in shown)
    assert any("from a table: The declared model lacks center-of-mass" in data.get("text/html", "") for data in shown)
    assert not [o for o in outputs if o.get("name") == "stderr"], "nothing is warned of"
