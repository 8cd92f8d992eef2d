"""The examples of docs/python.md, as a new user runs them one after the other."""

import re

import pytest
from conftest import ROOT, peer

BLOCK = re.compile(r"(?:<!-- needs: (\w+) -->\n)?```python\n(.*?)```", re.DOTALL)
known: dict[str, object] = {}


@pytest.mark.parametrize("number", range(6))
def test_example_runs(number, monkeypatch, tmp_path):
    blocks = BLOCK.findall((ROOT / "docs/python.md").read_text())
    assert len(blocks) == 6
    pytest.importorskip("pandas")
    for folder in ("urdf", "examples"):
        (tmp_path / folder).symlink_to(ROOT / folder)
    monkeypatch.chdir(tmp_path)
    needs, code = blocks[number]
    if needs:
        peer(needs)
    exec(code, known)
