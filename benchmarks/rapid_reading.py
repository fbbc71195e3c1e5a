r"""Prints how fast RAPID is read with a full syntax tree, beside a lark LALR grammar of the same language, and how much memory it takes.

Run: python benchmarks/rapid_reading.py [FILE|FOLDER...]. Without files it reads texts put together from the tests' samples, at four sizes.
Both readers take the same text in turns in one process, so that their ratio holds on any machine; the best of several turns counts.
Memory is the peak of what Python allocates while it reads, per byte of the file.
"""

from __future__ import annotations

import gc
import re
import statistics
import sys
import time
import tracemalloc
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import lark

from rapid_interp import SourceText
from rapid_interp.reading.files import read_texts
from rapid_interp.reading.modules import parse

ROOT = Path(__file__).parents[1]
GRAMMAR = ROOT / "tests" / "rapid_interp" / "second_grammar.lark"
SIZES = (10_000, 50_000, 450_000, 2_000_000)
"""Bytes; the largest of 600 public files has 444 kB (facts/rapid.md)."""
TURNS = 5
LEAST_MB_S, TARGET_RATIO, MOST_BYTES = 1.2, 4.0, 60.0
"""What issue 3 asks for: MB/s, times the speed of lark, bytes of memory per byte of the file."""

Reader = Callable[[str], object]


@dataclass(frozen=True)
class Reading:
    """What one text gave: bytes, MB/s of both readers, bytes of memory per byte of text."""

    name: str
    size: int
    speed: float
    lark_speed: float
    memory: float
    lark_memory: float

    @property
    def ratio(self) -> float:
        """How many times as fast as lark."""
        return self.speed / self.lark_speed


def own(text: str) -> object:
    """Reads with rapid_interp; the sample must be without error."""
    parsed = parse(SourceText("sample", text))
    if parsed.diagnostics:
        raise ValueError(parsed.diagnostics[0].format())
    return parsed


def lark_reader() -> Reader:
    """Gives the reader of the second grammar, its tables made beforehand."""
    return lark.Lark(GRAMMAR.read_text(), parser="lalr", lexer="basic").parse


def sample(size: int) -> str:
    """Gives a program of at least `size` bytes, made of the tests' sample modules."""
    folders = ("tests/rapid_interp/accepted", "tests/rapid_interp/programs", "mitl/atc")
    texts = [path.read_text() for folder in folders for path in sorted((ROOT / folder).glob("*.mod"))]
    modules = [re.sub(r"\A\s*%%%.*?%%%", "", text, flags=re.DOTALL) for text in texts]
    parts: list[str] = []
    length = 0
    while length < size:
        part = modules[len(parts) % len(modules)]
        parts.append(part)
        length += len(part)
    return "\n".join(parts)


def seconds(reader: Reader, text: str) -> float:
    """Gives the time of one reading."""
    gc.collect()
    begin = time.process_time()
    reader(text)
    return time.process_time() - begin


def memory(reader: Reader, text: str) -> float:
    """Gives the peak of memory while reading, per byte of the text."""
    gc.collect()
    tracemalloc.start()
    kept = reader(text)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    del kept
    return peak / len(text.encode())


def measured(name: str, text: str, other: Reader, turns: int = TURNS) -> Reading:
    """Gives speed and memory of both readers for a text, turn by turn."""
    own_times, other_times = [], []
    for _ in range(turns):
        own_times.append(seconds(own, text))
        other_times.append(seconds(other, text))
    size = len(text.encode())
    speed, lark_speed = (size / min(times) / 1e6 for times in (own_times, other_times))
    return Reading(name, size, speed, lark_speed, memory(own, text), memory(other, text))


def main(arguments: Sequence[str]) -> None:
    """Prints one line a text, and what issue 3 asks for."""
    if arguments:
        texts = [(Path(source.file).name, source.text) for source in read_texts(arguments)]
    else:
        texts = [("samples", sample(size)) for size in SIZES]
    other = lark_reader()
    print(f"{'text':24} {'bytes':>9} {'MB/s':>7} {'lark MB/s':>10} {'ratio':>6} {'memory':>8} {'lark memory':>12}")  # noqa: T201
    found: list[Reading] = []
    for name, text in texts:
        try:
            reading = measured(name, text, other)
        except (ValueError, lark.exceptions.LarkError) as problem:
            print(f"{name[:24]:24} left out: {str(problem).splitlines()[0]}")  # noqa: T201
            continue
        found.append(reading)
        print(  # noqa: T201
            f"{name[:24]:24} {reading.size:9d} {reading.speed:7.2f} {reading.lark_speed:10.3f} {reading.ratio:6.1f} "
            f"{reading.memory:6.1f} x {reading.lark_memory:10.1f} x"
        )
    if found:
        print(  # noqa: T201
            f"median {statistics.median(r.speed for r in found):.2f} MB/s (at least {LEAST_MB_S}), "
            f"{statistics.median(r.ratio for r in found):.1f} times lark (target {TARGET_RATIO:g}), "
            f"at most {max(r.memory for r in found):.1f} bytes of memory a byte (under {MOST_BYTES:g})"
        )


if __name__ == "__main__":
    main(sys.argv[1:])
