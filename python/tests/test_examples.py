# SPDX-License-Identifier: BSD-3-Clause
"""The examples run as their readers run them."""
import glob
import os
import re
import subprocess
import sys

import pytest

EXAMPLES = os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "examples")
PRINTED = {"01_fit.py": r"\d+ leaves of degree 4", "02_smooth.py": r"moved 0\.0010 RMS", "03_compare.py": r"^\d{3} of 80000 points",
           "04_lines.py": r"\d+ ridges and \d+ ravines", "05_mesh.py": r"1 border loop, coloured", "06_splats.py": r"discs of \d+ points, coloured",
           "07_register.py": r"within 0\.0000", "08_page.py": r"vase\.html \d+ bytes"}


def test_all_are_known():
    assert sorted(PRINTED) == sorted(os.path.basename(path) for path in glob.glob(os.path.join(EXAMPLES, "0*.py")))


@pytest.mark.parametrize("name", sorted(PRINTED))
def test_example(name, tmp_path):
    done = subprocess.run([sys.executable, os.path.join(EXAMPLES, name)], cwd=tmp_path, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, check=False)
    text = done.stdout.decode()
    assert done.returncode == 0 and re.search(PRINTED[name], text), text
    with open(os.path.join(EXAMPLES, name), encoding="utf-8") as file:
        made = re.findall(r'"(\w+\.(?:png|obj|slim|html))"', file.read())
    assert all((tmp_path / file).stat().st_size > 1000 for file in made)
