"""Systems of equations, and what is fitted to points: circles, axes, frames.

Invariant: pure functions of tuples in double precision, as RAPID's dnum matrices are; what has no solution is a `Fault`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import TypeAlias

from rapid_interp.library.table import LibraryRoutine
from rapid_interp.meaning.types import Value
from rapid_interp.running.values import Fault, Reference, error_number

Matrix: TypeAlias = tuple[tuple[float, ...], ...]
_TINY = 1e-12


def _wrong(message: str) -> Fault:
    return Fault(message, "RAPID-R338", number=error_number("ERR_ARGVALERR"))


def _part(matrix: Value, rows: float | None, columns: float | None) -> Matrix:
    m, n = int(rows or len(matrix)), int(columns or len(matrix[0]))
    if not (1 <= m <= len(matrix) and 1 <= n <= len(matrix[0])):
        raise _wrong(f"{m} x {n} is not inside of a matrix of {len(matrix)} x {len(matrix[0])}")
    return tuple(tuple(row[:n]) for row in matrix[:m])


def solved(matrix: Matrix, right: Sequence[Sequence[float]]) -> list[list[float]]:
    """Gives the solution X of a square system A X = B by elimination with pivots."""
    size = len(matrix)
    if any(len(row) != size for row in matrix) or len(right) < size:
        raise _wrong("the matrix must be square and as long as the right side")
    work = [[*row, *right[place]] for place, row in enumerate(matrix)]
    scale = max((abs(value) for row in matrix for value in row), default=0.0)
    for column in range(size):
        pivot = max(range(column, size), key=lambda row: abs(work[row][column]))
        if abs(work[pivot][column]) <= _TINY * scale or scale == 0:
            raise _wrong("the matrix is singular: there is no single solution")
        work[column], work[pivot] = work[pivot], work[column]
        for row in range(size):
            if row != column and work[row][column]:
                factor = work[row][column] / work[column][column]
                work[row] = [a - factor * b for a, b in zip(work[row], work[column], strict=True)]
    return [[value / work[place][place] for value in work[place][size:]] for place in range(size)]


def least_squares(matrix: Matrix, right: Sequence[float]) -> list[float]:
    """Gives the x for which A x is nearest to b."""
    columns = list(zip(*matrix, strict=True))
    normal = tuple(tuple(math.fsum(a * b for a, b in zip(one, other, strict=True)) for other in columns) for one in columns)
    sides = [[math.fsum(a * b for a, b in zip(column, right, strict=False))] for column in columns]
    return [row[0] for row in solved(normal, sides)]


def decomposed(matrix: Matrix) -> tuple[list[list[float]], list[float], list[list[float]]]:
    """Gives the columns of U, the singular values from the largest, and the columns of V with A = U S V^T, by one-sided Jacobi."""
    count = len(matrix[0])
    u = [list(column) for column in zip(*matrix, strict=True)]
    v = [[float(row == column) for row in range(count)] for column in range(count)]
    for _ in range(60):
        turned = False
        for p in range(count - 1):
            for q in range(p + 1, count):
                a, b = math.fsum(x * x for x in u[p]), math.fsum(x * x for x in u[q])
                c = math.fsum(x * y for x, y in zip(u[p], u[q], strict=True))
                if abs(c) <= 1e-15 * math.sqrt(a * b) or c == 0:
                    continue
                turned = True
                tau = (b - a) / (2 * c)
                t = math.copysign(1.0, tau) / (abs(tau) + math.hypot(1.0, tau))
                cos = 1 / math.hypot(1.0, t)
                for pair in (u, v):
                    pair[p], pair[q] = (
                        [cos * x - cos * t * y for x, y in zip(pair[p], pair[q], strict=True)],
                        [cos * t * x + cos * y for x, y in zip(pair[p], pair[q], strict=True)],
                    )
        if not turned:
            break
    lengths = [math.sqrt(math.fsum(x * x for x in column)) for column in u]
    order = sorted(range(count), key=lambda place: -lengths[place])
    columns = [[x / lengths[place] if lengths[place] > 0 else 0.0 for x in u[place]] for place in order]
    return columns, [lengths[place] for place in order], [v[place] for place in order]


def _rows(columns: Sequence[Sequence[float]], shape: Value) -> Value:
    """Gives columns as a matrix of the shape of `shape`, with zeros where there is nothing."""
    return tuple(
        tuple(columns[j][i] if j < len(columns) and i < len(columns[j]) else 0.0 for j in range(len(shape[0]))) for i in range(len(shape))
    )


def _solve(matrix: Value, rows: float | None, columns: float | None, right: Value, result: Reference) -> None:
    part = _part(matrix, rows, columns)
    if len(part) == len(part[0]):
        found = [row[0] for row in solved(part, [[value] for value in right])]
    else:
        found = least_squares(part, right[: len(part)])
    whole = result.get()
    if len(whole) < len(found):
        raise _wrong(f"the result needs {len(found)} elements, has {len(whole)}")
    result.put((*found, *whole[len(found) :]))


def _inverse(matrix: Value, rows: float | None, _columns: Value, result: Reference) -> None:
    part = _part(matrix, rows, rows)
    size = len(part)
    found = solved(part, [[float(row == column) for column in range(size)] for row in range(size)])
    result.put(_rows([list(column) for column in zip(*found, strict=True)], result.get()))


def _svd(matrix: Value, rows: float | None, columns: float | None, u: Reference, s: Reference, v: Reference) -> None:
    left, values, right = decomposed(_part(matrix, rows, columns))
    u.put(_rows(left, u.get()))
    s.put(tuple(values[place] if place < len(values) else 0.0 for place in range(len(s.get()))))
    v.put(_rows(right, v.get()))


def _errors(distances: Sequence[float]) -> tuple[float, float]:
    return max(distances), math.fsum(distances) / len(distances)


def fitted_circle(points: Sequence[Value]) -> tuple[Value, float, Value]:
    """Gives centre, radius and normal of the circle nearest to points (its plane by SVD, the circle in it by least squares)."""
    if len(points) < 3:
        raise _wrong(f"a circle needs at least 3 points, found {len(points)}")
    middle = tuple(math.fsum(axis) / len(points) for axis in zip(*points, strict=True))
    spread = tuple(tuple(a - b for a, b in zip(point, middle, strict=True)) for point in points)
    _, sizes, axes = decomposed(spread)
    if sizes[1] <= 1e-9 * max(sizes[0], 1e-300):
        raise _wrong("the points lie in a line: they are on no circle")
    x, y = axes[0], axes[1]
    flat = [(math.fsum(a * b for a, b in zip(p, x, strict=True)), math.fsum(a * b for a, b in zip(p, y, strict=True))) for p in spread]
    a, b, c = least_squares(tuple((2 * u, 2 * w, 1.0) for u, w in flat), [u * u + w * w for u, w in flat])
    centre = tuple(m + a * p + b * q for m, p, q in zip(middle, x, y, strict=True))
    normal = (x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0])
    return centre, math.sqrt(max(c + a * a + b * b, 0.0)), normal


def _fit_circle(
    points: Value, count: float | None, centre: Reference, radius: Reference, normal: Reference, rms: Reference | None,
    most: Reference | None, worst: Reference | None,
) -> None:  # fmt: skip
    used = points[: int(count)] if count is not None else points
    middle, size, axis = fitted_circle(used)
    centre.put(middle)
    radius.put(size)
    normal.put(axis)
    misses = [_off_circle(point, middle, size, axis) for point in used]
    for reference, value in (
        (rms, math.sqrt(math.fsum(miss * miss for miss in misses) / len(misses))),
        (most, max(misses)),
        (worst, float(misses.index(max(misses)) + 1)),
    ):
        if reference is not None:
            reference.put(value)


def _off_circle(point: Value, centre: Value, radius: float, axis: Value) -> float:
    away = tuple(a - b for a, b in zip(point, centre, strict=True))
    height = math.fsum(a * b for a, b in zip(away, axis, strict=True))
    in_plane = math.sqrt(max(math.fsum(a * a for a in away) - height * height, 0.0))
    return math.hypot(height, in_plane - radius)


def told(errors: Callable[[], Sequence[float]], most: Reference, mean: Reference) -> None:
    """Puts the largest and the mean of some errors where the program wants them."""
    largest, middle = _errors(errors())
    most.put(largest)
    mean.put(middle)


# ASSUMPTION A-171: order and names of the arguments of the Matrix instructions and FitCircle, from memory.
_SIZE = r"\num A_Rows \num A_Columns"
ROUTINES = (
    LibraryRoutine(rf"PROC MatrixSolve(dnum A{{*,*}} {_SIZE}, dnum b{{*}}, INOUT dnum x{{*}})", _solve),
    LibraryRoutine(rf"PROC MatrixInverse(dnum A{{*,*}} {_SIZE}, INOUT dnum Inverse{{*,*}})", _inverse),
    LibraryRoutine(rf"PROC MatrixSVD(dnum A{{*,*}} {_SIZE}, INOUT dnum U{{*,*}}, INOUT dnum S{{*}}, INOUT dnum V{{*,*}})", _svd),
    LibraryRoutine(
        r"PROC FitCircle(pos Points{*} \num NumPoints, INOUT pos Center, INOUT num Radius, INOUT pos Normal"
        r" \INOUT num RMS \INOUT num MaxErr \INOUT num IndexWorst)",
        _fit_circle,
    ),
)
