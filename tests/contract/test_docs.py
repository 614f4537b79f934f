"""What the pages say runs, and their links lead somewhere."""

import doctest
import re
from pathlib import Path

import clips
import numpy as np
import pytest
import quatfilt as qf

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
FENCED = re.compile(r"^```(?P<language>[a-z]+)\n(?P<code>.*?)^```$", re.MULTILINE | re.DOTALL)
LINK = re.compile(r"!?\[[^\]]*\]\((?P<target>[^)#\s]+)(?:#[^)]*)?\)")

every_page = pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))


@pytest.fixture(scope="module")
def walk():
    """A noisy motion that stands for the reader's own."""
    rng = np.random.default_rng(0)
    q = clips.noisy(rng, clips.walk(rng, 240, 4), 0.03)
    skeleton = qf.Skeleton(["hips", "thigh", "shin", "foot"], [-1, 0, 1, 2], np.full((4, 3), -20.0))
    return qf.Motion(q, clips.path(rng, 240), fps=120, skeleton=skeleton)


@every_page
def test_examples_run(page, walk, tmp_path, monkeypatch):
    """In one namespace per page, in order, in a folder with `walk.bvh` and a folder `takes`."""
    (tmp_path / "takes").mkdir()
    for name in ("walk.bvh", "takes/one.bvh", "takes/two.bvh"):
        qf.write_motion(tmp_path / name, walk)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "Agg")
    text = page.read_text(encoding="utf-8")
    namespace = {"__name__": "__main__"}
    for block in FENCED.finditer(text):
        line = text[: block.start("code")].count("\n")
        if block["language"] == "python":
            # Empty lines put the block where it stands on the page, for the traceback.
            exec(compile("\n" * line + block["code"], str(page), "exec"), namespace)  # noqa: S102
        elif block["language"] == "pycon":
            example = doctest.DocTestParser().get_doctest(
                block["code"], namespace, page.name, str(page), line
            )
            runner = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE)
            runner.run(example, clear_globs=False)
            assert runner.summarize().failed == 0
            namespace |= example.globs


@every_page
def test_links_lead_to_files(page):
    for link in LINK.finditer(page.read_text(encoding="utf-8")):
        target = link["target"]
        if not target.startswith(("http:", "https:", "mailto:")):
            assert (page.parent / target).exists(), target


def test_every_page_is_on_the_first_one():
    index = ROOT / "docs" / "index.md"
    linked = {
        (index.parent / link["target"]).resolve() for link in LINK.finditer(index.read_text(encoding="utf-8"))
    }
    pages = {page for page in PAGES if page.is_relative_to(index.parent)} - {index}
    assert {page for page in pages if "results" not in page.parts} <= linked
