"""The CSV tables: what is read and what is refused, with file and line."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from warpgran.case.tables import BedTable, TableError, read_bed, read_profile


def test_bed_is_read_whatever_its_dress(tmp_path: Path) -> None:
    text = '\ufeff# surveyed in May\n b , x \n\n1e-2, 0\n# a remark\n 2e-2 ,"1.5"\r\n'
    (tmp_path / "bed.csv").write_text(text, encoding="utf-8")
    bed = read_bed("bed.csv", tmp_path)
    assert bed.path == "bed.csv"
    assert bed.x.tolist() == [0.0, 1.5]
    assert bed.b.tolist() == [0.01, 0.02]
    assert bed.x.dtype == np.float64


def test_profile_with_and_without_phi(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("x,h\n0,0\n1,2\n")
    (tmp_path / "b.csv").write_text("h,phi,x\n0,0.5,0\n2,0.6,1\n")
    assert read_profile("a.csv", tmp_path).phi is None
    full = read_profile(tmp_path / "b.csv")
    assert full.phi is not None
    assert full.phi.tolist() == [0.5, 0.6]
    assert full.h.tolist() == [0.0, 2.0]
    assert full.v is None


def test_profile_with_velocity_of_either_sign(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("x,v,h\n0,-1.5,0\n1,2,2\n")
    profile = read_profile("a.csv", tmp_path)
    assert profile.v is not None
    assert profile.v.tolist() == [-1.5, 2.0]
    assert profile.phi is None
    (tmp_path / "b.csv").write_text("x,v,h\n0,inf,0\n1,2,2\n")
    with pytest.raises(TableError, match=r"b\.csv:2: v = inf is not a finite number"):
        read_profile("b.csv", tmp_path)


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ("", None, "is empty"),
        ("# only a remark\n\n", None, "is empty"),
        ("x,h\n0,0\n1,1\n", 1, 'the columns are "x,h"; allowed: x,b'),
        ("x,b,c\n0,0,0\n1,1,1\n", 1, "columns"),
        ("x,x,b\n0,0,0\n1,1,1\n", 1, "columns"),
        ("0,0\n1,1\n", 1, "columns"),
        ("x,b\n0,0\n1\n2,2\n", 3, "has 1 values; allowed: 2"),
        ("x,b\n0,0\n1,1,1\n", 3, "has 3 values"),
        ("x,b\n0,0\n1,high\n", 3, '"high" is not a number'),
        ("x,b\n0,0\n1,\n", 3, '"" is not a number'),
        ("x,b\n0,0\n1,1_0\n", 3, '"1_0" is not a number'),
        ("x;b\n0,0;0,1\n1,0;0,2\n", 1, "is separated by semicolons; allowed: commas, and points in numbers"),
        ("x\tb\r\n0\t0\r\n1\t1\r\n", 1, "is separated by tabs; allowed: commas"),
        ("x,b\n0,0,0,1\n", 2, "has 4 values; allowed: 2 (x,b); a decimal comma is none, write a point"),
        ('x,b\n0,"0,15"\n', 2, '"0,15" is not a number; allowed: 0.15'),
        ("x,b\n#\n0,0\n1,nan\n", 4, "b = nan is not a finite number"),
        ("x,b\n0,0\ninf,1\n", 3, "x = inf is not a finite number"),
        ("x,b\n0,0\n0,1\n", 3, "strictly increasing"),
        ("x,b\n0,0\n2,1\n1,1\n", 4, "x = 1.0 after 2.0"),
        ("x,b\n", None, "0 rows"),
        ("x,b\n0,0\n", None, "1 row of numbers; allowed: at least 2"),
    ],
)
def test_bad_bed_names_file_and_line(tmp_path: Path, text: str, line: int | None, words: str) -> None:
    path = tmp_path / "bed.csv"
    path.write_text(text)
    with pytest.raises(TableError) as caught:
        read_bed("bed.csv", tmp_path)
    [message] = caught.value.messages
    assert message.startswith(f"{path}:{line}: " if line else f"{path}: ")
    assert words in message


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ("x,b\n0,0\n1,1\n", 1, "allowed: x,h and optionally phi,v, in any order"),
        ("x,h\n0,1\n1,-0.1\n", 3, "h = -0.1 is out of range; allowed: >= 0, in m"),
        ("x,h,phi\n0,1,0\n1,1,0.5\n", 2, "phi = 0.0 is out of range; allowed: > 0 and < 1"),
        ("x,h,phi\n0,1,0.5\n1,1,1\n", 3, "phi = 1.0 is out of range"),
        ("x,h,phi\n0,1,0.5\n1,1,nan\n", 3, "phi = nan is not a finite number"),
        ("x,h\n0,0\n1,0\n", None, "h is 0 in every row"),
    ],
)
def test_bad_profile_names_file_and_line(tmp_path: Path, text: str, line: int | None, words: str) -> None:
    path = tmp_path / "p.csv"
    path.write_text(text)
    with pytest.raises(TableError) as caught:
        read_profile(path)
    [message] = caught.value.messages
    assert message.startswith(f"{path}:{line}: " if line else f"{path}: ")
    assert words in message


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [("no.csv", None, "No such file"), (".", None, "it is a folder"), ("l.csv", b"x,b\n\xff,1\n", "UTF-8")],
)
def test_unreadable_file(tmp_path: Path, name: str, content: bytes | None, words: str) -> None:
    if content is not None:
        (tmp_path / name).write_bytes(content)
    with pytest.raises(TableError, match=words):
        read_bed(name, tmp_path)


def test_all_faults_at_once_but_not_without_end(tmp_path: Path) -> None:
    (tmp_path / "p.csv").write_text("x,h\n0,-1\n0,1\n")
    with pytest.raises(TableError) as caught:
        read_profile("p.csv", tmp_path)
    assert len(caught.value.messages) == 2
    (tmp_path / "p.csv").write_text("x,h\n" + "0,a\n" * 500)
    with pytest.raises(TableError) as caught:
        read_profile("p.csv", tmp_path)
    assert len(caught.value.messages) == 11
    assert caught.value.messages[-1] == "and 490 more of this table"


def test_arrays_instead_of_a_file() -> None:
    x = np.array([0.0, 1.0])
    bed = read_bed({"x": x, "b": [3, 4]})
    assert bed.path is None
    assert bed.plain() == {"x": [0.0, 1.0], "b": [3.0, 4.0]}
    x[0] = -7.0
    assert bed.x[0] == 0.0


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ({"x": [0, 1]}, "the columns are"),
        ({"x": [0, 1], "b": [0]}, "x has 2, b has 1"),
        ({"x": [0, 1], "b": ["0", "1"]}, "column b is not a list of numbers"),
        ({"x": [0, 1], "b": [True, False]}, "column b is not a list of numbers"),
        ({"x": [0, 1], "b": [[0], [1, 2]]}, "column b is not a list of numbers"),
        ({"x": [0, 1], "b": 3.0}, "column b is not a list of numbers"),
        ({"x": [1, 0], "b": [0, 0]}, "row 2: x = 0.0 after 1.0"),
        ({"x": [0, 1], "b": [0, float("nan")]}, "row 2: b = nan"),
        ({"x": [], "b": []}, "0 rows"),
    ],
)
def test_bad_arrays(table: dict[str, Any], words: str) -> None:
    with pytest.raises(TableError, match=r"^table: ") as caught:
        read_bed(table)
    assert words in str(caught.value)


def test_tables_are_frozen_and_compared_by_value() -> None:
    bed = read_bed({"x": [0, 1], "b": [0, 1]})
    with pytest.raises(ValueError, match="read-only"):
        bed.b[0] = 1.0
    with pytest.raises(AttributeError):
        bed.b = np.zeros(2)  # type: ignore[misc]
    same = read_bed({"b": [0, 1], "x": [0, 1]})
    assert bed == same
    assert hash(bed) == hash(same)
    assert bed != read_bed({"x": [0, 1], "b": [0, 2]})
    assert bed != BedTable(path="b.csv", x=bed.x, b=bed.b)
