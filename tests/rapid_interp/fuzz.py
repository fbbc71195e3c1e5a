r"""A fuzzer for the interpreter: whatever the text, there is a program or a `RapidError(s)`, within 2 s and 500 MB.

Run: python -m tests.rapid_interp.fuzz [COUNT] [--seed N] [--workers N]. A short run is part of the tests (test_fuzz.py).
Programs come from a seed number alone: made from the grammar, from sample programs by exchanging their tokens and statements, or by
changing bytes. Every program that loads is run a little. Failures are told with their seed and kept in the folder `out/fuzz_failures`.
"""

from __future__ import annotations

import argparse
import multiprocessing
import random
import re
import resource
import signal
import sys
import time
import traceback
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from rapid_interp import RapidError, RapidErrors, SourceText, Task, load_text
from rapid_interp.effects import Failed, Reply
from rapid_interp.library.catalogue import catalogue
from rapid_interp.meaning.types import PREDEFINED
from rapid_interp.reading.files import decoded
from rapid_interp.reading.lexer import KEYWORDS, NAME, NUMBER, STRING, tokenize
from tests.rapid_interp.world import World

LIMIT_S, LIMIT_BYTES = 2.0, 500_000_000
MAX_STEPS, MAX_EFFECTS = 300, 50
INPUTS = "".join(f"! @ {place} di1={place % 2}\n" for place in range(1, 9)) + "! answer 1\n! answer 2\n" * 3
WRONG_REPLIES = (0.0, 1.0, 5.5, None, "text", Failed("ERR_ROBLIMIT", "out of reach"), Failed("", "lost"))
"""What a driver might reply that does not suit the effect, or a refusal."""
FOLDER = Path(__file__).parent
VALID = [path.read_text() for name in ("programs", "accepted") for path in sorted((FOLDER / name).glob("*.mod"))]
SEEDS = VALID + [path.read_text() for path in sorted((FOLDER / "diagnostics").glob("*.mod"))]
WORDS = [*sorted(KEYWORDS), *'+-*/=<>()[]{},;:.\\?|%!"', ":=", "<>", " x ", "1", "9E9", "0", "-1", "1E30", "\n", '"s"', "<EXP>", "\x00"]
NAMES = [routine.name for routine in catalogue().values()]
TYPES = ("num", "bool", "string", "pos", "robtarget", "dnum", "orient", "pose", "clock", "intnum", "speeddata")
SHAPES = {"row": "{3}", "table": "{3,3}"}
LITERALS = {
    "num": ("0", "1", "-3", "2.5", "1E30", "9E9", "0xFF"), "bool": ("TRUE", "FALSE"), "string": ('""', '"a"', '"1,2"', '"ä\\\\"'),
    "pos": ("[1,2,3]",), "dnum": ("4294967295",), "orient": ("[1,0,0,0]",), "pose": ("[[1,2,3],[1,0,0,0]]",),
    "robtarget": ("[[1,2,3],[1,0,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]]",), "speeddata": ("v100", "[1,2,3,4]"),
} | {f"signal{kind}": (f"{kind}1",) for kind in ("di", "do", "gi", "go", "ai", "ao")}  # fmt: skip


# ---------------------------------------------------------------- programs


class Writer:
    """Writes a program from the grammar: mostly of fitting types, so that much of it loads and runs."""

    def __init__(self, rng: random.Random) -> None:
        self.rng = rng
        self.result = ""
        self.data = {f"{kind}{place}": kind for kind in TYPES for place in range(2)} | {f"{kind}0": kind for kind in sorted(PREDEFINED)}
        self.rows = {f"{kind}{shape}": f"{kind} {kind}{shape}{size}" for kind in sorted(PREDEFINED) for shape, size in SHAPES.items()}
        self.routines = [f"p{place}" for place in range(rng.randint(1, 3))]

    def program(self) -> str:
        lines = ["  VAR num list{4} := [1,2,3,4];", "  VAR pos grid{2,3};", "  RECORD rec", "    num a;", "    pos b;", "  ENDRECORD"]
        lines += ["  VAR rec thing;", "  VAR rec things{3};"]
        for name in ["main", *self.routines]:
            lines += [f"  PROC {name}()", *self.block(3), *self.handler(), "  ENDPROC"]
        self.result = " 1"
        lines += ["  FUNC num f(num n)", *self.block(1), f"    RETURN {self.value('num', 2)};", "  ENDFUNC"]
        self.result = ""
        lines += ["  TRAP t", *self.block(1), "  ENDTRAP"]
        lines += ["  PROC q(num a, INOUT num b \\num c | string d \\switch on)", *self.block(2), "    IF Present(c) b := c;"]
        lines += ["    IF a > 0 q a - 1, b\\c?c\\on?on;", *self.handler(), "  ENDPROC"]
        text = "\n".join(lines)
        used = [name for name in self.data if name in text]
        lines[:0] = [f"  {self.rng.choice(('VAR', 'PERS', 'VAR'))} {self.data[name]} {name};" for name in used]
        words = set(re.findall(r"\w+", text))
        lines[:0] = [f"  {self.rng.choice(('VAR', 'PERS'))} {self.rows[name]};" for name in self.rows if name in words]
        return "MODULE fuzz\n" + "\n".join(lines) + "\nENDMODULE\n"

    def handler(self) -> list[str]:
        lines = []
        if self.rng.random() < 0.3:
            lines += ["  ERROR", *self.block(1), f"    {self.rng.choice(('RETRY', 'TRYNEXT', 'RAISE', 'RETURN'))};"]
        if self.rng.random() < 0.15:
            lines += ["  UNDO", *self.block(1)]
        return lines

    def block(self, depth: int) -> list[str]:
        return [line for _ in range(self.rng.randint(0, 4)) for line in self.statement(depth)]

    def statement(self, depth: int) -> list[str]:
        rng = self.rng
        kind = rng.choice(TYPES[:4])
        match rng.randrange(15 if depth > 0 else 8):
            case 0 | 1:
                return [f"{self.place(kind)} := {self.value(kind, 3)};"]
            case 2 | 3:
                return [self.instruction()]
            case 4:
                options = rng.choice(("", "\\c:=2", '\\d:="x"', "\\on", "\\c:=1\\on"))
                call = f"q {self.value('num', 1)}, {self.place('num')}{options};"
                return [f"{rng.choice(self.routines)};", call, f'%"p" + "{rng.randrange(4)}"%;']
            case 5:
                return [f"TPWrite {self.value('string', 2)}\\Num:={self.value('num', 2)};"]
            case 6:
                return [
                    rng.choice(
                        ("Stop;", "EXIT;", "ExitCycle;", f"RETURN{self.result};", "WaitTime 0.1;", f"RAISE {self.value('num', 1)};", ";")
                    )
                ]
            case 7:
                return [rng.choice(("CONNECT intnum0 WITH t;", "ISignalDI di1, 1, intnum0;", "ITimer 0.1, intnum0;", "IDelete intnum0;"))]
            case 8:
                return [f"IF {self.value('bool', 3)} THEN", *self.block(depth - 1), "ELSE", *self.block(depth - 1), "ENDIF"]
            case 9:
                return [f"WHILE {self.value('bool', 2)} DO", *self.block(depth - 1), "ENDWHILE"]
            case 10:
                bounds = f"FROM {self.value('num', 1)} TO {self.value('num', 1)}"
                return [f"FOR i {bounds}{rng.choice(('', ' STEP 2', ' STEP -1'))} DO", *self.block(depth - 1), "ENDFOR"]
            case 11:
                cases = [f"CASE {self.value('num', 1)}, {self.value('num', 1)}:", *self.block(depth - 1)]
                return [f"TEST {self.value('num', 2)}", *cases, "DEFAULT:", *self.block(depth - 1), "ENDTEST"]
            case 12:
                return [f"IF {self.value('bool', 2)} {self.statement(0)[0]}"]
            case 13:
                label = f"l{rng.randrange(10**6)}"
                return [f"{label}:", *self.block(depth - 1), f"IF {self.value('bool', 1)} GOTO {label};"]
            case _:
                return [f"WaitUntil {self.value('bool', 2)}\\MaxTime:=0.2;"]

    def instruction(self) -> str:
        """A library routine with arguments by its head, now and then with wrong ones."""
        routine = self.rng.choice(list(catalogue().values()))
        if "(" not in routine.head or routine.is_function:
            return f"{self.place('num')} := {self.value('num', 2)};"
        return f"{routine.name} {self.arguments(routine.head)};"

    def arguments(self, head: str) -> str:
        given: list[str] = []
        for choice in head[head.index("(") + 1 : -1].replace("{*,*}", "{**}").replace("\\", ",\\").replace(" | ,", " | ").split(","):
            part = self.rng.choice([(choice[:1] == "\\") * "\\" + one.strip(" \\") for one in choice.strip().split(" | ")])
            words = part.replace("\\", " ").split()
            if not words or (part.strip().startswith("\\") and self.rng.random() < 0.7):
                continue
            kind, name = words[-2:] if len(words) > 1 else ("num", "x")
            name, _, shape = name.partition("{")
            kind = {"anytype": "pos", "anydata": "num", "numeric": "num"}.get(kind, kind)
            kind = PREDEFINED[kind].name if kind in PREDEFINED else kind
            if shape:
                value = f"{kind}{'table' if '**' in shape else 'row'}"
                given.append(f"\\{name}:={value}" if part.strip().startswith("\\") else value)
                continue
            value = self.place(kind) if words[0] in ("INOUT", "VAR", "PERS") else self.value(kind, 1)
            if kind == "switch":
                given.append(f"\\{name}")
            else:
                given.append(f"\\{name}:={value}" if part.strip().startswith("\\") else value)
        return ", ".join(given)

    def place(self, kind: str) -> str:
        names = [name for name, other in self.data.items() if other == kind]
        if kind == "num" and self.rng.random() < 0.4:
            return self.rng.choice(("list{2}", "list{num0}", "pos0.x", "thing.b.y", "things{3}.a", "grid{2,1}.z", "robtarget0.trans.x"))
        return self.rng.choice(names) if names else LITERALS.get(kind, ("num0",))[0]

    def value(self, kind: str, depth: int) -> str:
        rng = self.rng
        roll = rng.random()
        if depth <= 0 or roll < 0.3:
            return rng.choice(LITERALS[kind]) if rng.random() < 0.6 and kind in LITERALS else self.place(kind)
        functions = [routine for routine in catalogue().values() if routine.head.startswith(f"FUNC {kind} ") and "(" in routine.head]
        if roll < 0.5 and functions:
            chosen = rng.choice(functions)
            return f"{chosen.name}({self.arguments(chosen.head)})"
        match kind:
            case "num":
                sign = rng.choice(("+", "-", "*", "/", "DIV", "MOD"))
                return f"({self.value('num', depth - 1)} {sign} {self.value('num', depth - 1)})"
            case "bool":
                if roll < 0.75:
                    sign = rng.choice(("<", ">", "=", "<>", "<=", ">="))
                    return f"{self.value('num', depth - 1)} {sign} {self.value('num', depth - 1)}"
                sign = rng.choice(("AND", "OR", "XOR"))
                return f"({rng.choice(('', 'NOT '))}{self.value('bool', depth - 1)} {sign} {self.value('bool', depth - 1)})"
            case "string":
                return f"{self.value('string', depth - 1)} + {self.value('string', depth - 1)}"
            case _:
                return self.place(kind) if rng.random() < 0.98 else self.value(rng.choice(TYPES), depth - 1)


def from_grammar(rng: random.Random) -> str:
    """Gives a program made from the grammar, one time in three with a token changed."""
    text = Writer(rng).program()
    return tokens_changed(rng, text) if rng.random() < 0.33 else text


def tokens_changed(rng: random.Random, text: str) -> str:
    """Gives a text with some tokens taken away, doubled, exchanged or put in."""
    tokens = tokenize(SourceText("seed", text))
    words = tokens.texts[:-1]
    for _ in range(rng.randint(1, 5)):
        if len(words) < 2:
            break
        place, other = rng.randrange(len(words)), rng.randrange(len(words))
        match rng.randrange(5):
            case 0:
                del words[place : place + rng.randint(1, 4)]
            case 1:
                words[place:place] = words[other : other + rng.randint(1, 8)]
            case 2:
                words[place], words[other] = words[other], words[place]
            case 3:
                words.insert(place, rng.choice(WORDS))
            case _:
                words[place] = rng.choice(NAMES)
    return "\n".join(" ".join(words[at : at + 12]) for at in range(0, len(words), 12))


ALIKE = (
    ("+", "-", "*", "/", "DIV", "MOD"),
    ("<", ">", "<=", ">=", "=", "<>"),
    ("AND", "OR", "XOR"),
    ("RETRY", "TRYNEXT", "RAISE", "RETURN", "EXIT"),
    ("VAR", "PERS", "CONST"),
    ("TRUE", "FALSE"),
)
NUMBERS = ("0", "1", "-1", "2", "3", "1000", "0.5", "1E30", "9E9", "1E-30", "16777217", "0xFF")


def tokens_exchanged_for_alike(rng: random.Random, text: str) -> str:
    """Gives a text with some tokens exchanged for others of their kind: mostly it still loads and does something else."""
    source = SourceText("seed", text)
    tokens = tokenize(source)
    pieces, ends = [], 0
    names = [word for kind, word in zip(tokens.kinds, tokens.texts, strict=True) if kind == NAME]
    strings = [word for kind, word in zip(tokens.kinds, tokens.texts, strict=True) if kind == STRING] + ['""', '"1"']
    chosen = {rng.randrange(len(tokens.kinds)) for _ in range(rng.randint(1, 12))}
    for place, (kind, word, start) in enumerate(zip(tokens.kinds, tokens.texts, tokens.starts, strict=True)):
        alike = next((row for row in ALIKE if kind in row), None)
        other = word
        if place in chosen:
            if kind == NUMBER:
                other = rng.choice(NUMBERS)
            elif kind == STRING:
                other = rng.choice(strings)
            elif kind == NAME and rng.random() < 0.3:
                other = rng.choice(names)
            elif alike:
                other = rng.choice(alike)
        if word:
            pieces += [text[ends:start], other]
            ends = start + len(word)
    return "".join(pieces) + text[ends:]


def statements_changed(rng: random.Random) -> str:
    """Gives a sample whose lines are exchanged with those of another; lines are mostly statements."""
    lines, others = rng.choice(SEEDS).splitlines(), rng.choice(SEEDS).splitlines()
    for _ in range(rng.randint(1, 8)):
        place, other = rng.randrange(len(lines)), rng.randrange(len(others))
        match rng.randrange(3):
            case 0:
                lines[place:place] = others[other : other + rng.randint(1, 6)]
            case 1:
                lines[place] = others[other]
            case _:
                del lines[place : place + rng.randint(1, 3)]
        lines = lines or [""]
    return "\n".join(lines)


def bytes_changed(rng: random.Random) -> str:
    """Gives a sample with bytes changed, taken away, doubled or cut off, read as a file would be."""
    raw = bytearray(rng.choice(SEEDS).encode())
    for _ in range(rng.randint(1, 8)):
        place, other = sorted(rng.randrange(len(raw) + 1) for _ in range(2))
        match rng.randrange(5):
            case 0:
                del raw[place : min(other, place + 30)]
            case 1:
                raw[place:place] = rng.choice(WORDS).encode()
            case 2:
                raw = raw[:place] + raw[place:other][:200] * rng.randint(2, 4) + raw[other:]
            case 3 if rng.random() < 0.3:
                raw = raw[:place]
            case _:
                raw[place : place + 1] = bytes([rng.randrange(256)])
        raw = raw or bytearray(b"x")
    return decoded(bytes(raw))


def nested(rng: random.Random) -> str:
    """Gives a program in which something is inside itself many times."""
    count = rng.choice((50, 79, 81, 300, 3000))
    opener, closer = rng.choice(
        (("(", ")"), ("[", "]"), ("Abs(", ")"), ("list{", "}"), ("-", ""), ("NOT ", ""), ("(1 + ", ")"), ("f(\\a:=", ")"), ("x.", ""))
    )
    blocks = (("IF TRUE THEN\n", "ENDIF\n"), ("WHILE FALSE DO\n", "ENDWHILE\n"), ("FOR i FROM 1 TO 2 DO\n", "ENDFOR\n"), ("IF TRUE ", ""))
    if rng.random() < 0.5:
        opener, closer = rng.choice(blocks)
        body = opener * count + "x := 1;\n" + closer * rng.choice((count, count // 2))
    else:
        body = "x := " + opener * count + "1" + closer * rng.choice((count, count // 2)) + ";"
    return f"MODULE m\nPROC main()\nVAR num x;\n{body}\nENDPROC\nENDMODULE"


def program(seed: int) -> str:
    """Gives the text of a seed number."""
    rng = random.Random(seed)  # noqa: S311 - a fuzzer needs to be repeatable, not secret
    makers: list[Callable[[random.Random], str]] = [
        from_grammar, lambda rng: tokens_changed(rng, rng.choice(SEEDS)), statements_changed, bytes_changed, from_grammar,
        lambda rng: tokens_exchanged_for_alike(rng, rng.choice(VALID)), lambda rng: tokens_exchanged_for_alike(rng, Writer(rng).program()),
    ]  # fmt: skip
    return nested(rng) if seed % 100 == 99 else makers[seed % len(makers)](rng)


# ---------------------------------------------------------------- running


def digest(text: str, seed: int = 0) -> str:
    """Loads a text and runs what loads a little: gives `refused`, `ran` or `failed`, and lets anything but the two errors through."""
    rng = random.Random(seed)  # noqa: S311 - see above
    try:
        found = load_text(text)
    except RapidErrors as errors:
        for finding in errors.diagnostics:
            assert finding.line >= 1
            assert finding.column >= 1
            assert finding.format()
        return "refused"
    outcome = "ran"
    for routine in (routine for routine in found.routines if routine.kind == "PROC" and all(p.optional for p in routine.parameters)):
        try:
            _run(found.start(routine.name, routine.module, max_steps=MAX_STEPS), rng)
        except RapidError as error:
            assert error.format()  # noqa: PT017 - the fuzzer is no test
            outcome = "failed while running"
    return outcome


def _run(task: Task, rng: random.Random) -> None:
    run = task.run()
    world = World(INPUTS)
    reply: Reply = None
    try:
        for _ in range(MAX_EFFECTS):
            effect = run.send(reply)
            reply = rng.choice(WRONG_REPLIES) if rng.random() < 0.02 else world.reply(effect)
    except StopIteration:
        pass
    finally:
        run.close()


class TooSlow(Exception):  # noqa: N818 - a verdict
    """A program took more than its time."""


def _too_slow(*_: object) -> None:
    raise TooSlow(f"more than {LIMIT_S:g} s")


@contextmanager
def time_limit() -> Iterator[None]:
    """Raises `TooSlow` when what is inside takes more than LIMIT_S of CPU time."""
    signal.signal(signal.SIGPROF, _too_slow)
    signal.setitimer(signal.ITIMER_PROF, LIMIT_S)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)


def guarded(seed: int) -> tuple[int, str, float]:
    """Gives seed, outcome and CPU time of one program; an outcome with a traceback in it is a failure."""
    begin = time.process_time()
    text = ""
    try:
        with time_limit():
            text = program(seed)
            outcome = digest(text, seed)
    except BaseException:  # noqa: BLE001 - that is what the fuzzer looks for
        outcome = traceback.format_exc()
        kept = Path("out/fuzz_failures")
        kept.mkdir(parents=True, exist_ok=True)
        (kept / f"{seed}.mod").write_text(text, encoding="utf-8", errors="surrogatepass")
    return seed, outcome, time.process_time() - begin


def limit_memory() -> None:
    """Bounds the memory of this process to LIMIT_BYTES more than it has: beyond it a program fails with MemoryError."""
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    most = pages * resource.getpagesize() + LIMIT_BYTES
    resource.setrlimit(resource.RLIMIT_AS, (most, most))


def main() -> int:
    """Runs many programs and prints what became of them."""
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("count", nargs="?", type=int, default=2000)
    arguments.add_argument("--seed", type=int, default=0)
    arguments.add_argument("--workers", type=int, default=2)
    given = arguments.parse_args()
    outcomes: Counter[str] = Counter()
    slowest, failures, begin = (0.0, 0), 0, time.monotonic()
    with multiprocessing.Pool(given.workers, initializer=limit_memory) as pool:
        for seed, outcome, spent in pool.imap_unordered(guarded, range(given.seed, given.seed + given.count), chunksize=100):
            slowest = max(slowest, (spent, seed))
            failed = outcome.startswith("Traceback")
            outcomes["FAILED" if failed else outcome] += 1
            if failed and (failures := failures + 1) <= 20:
                print(f"seed {seed}:\n{outcome}", flush=True)  # noqa: T201
    largest = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024
    told = ", ".join(f"{count} {name}" for name, count in outcomes.most_common())
    print(f"{given.count} programs in {time.monotonic() - begin:.0f} s: {told}")  # noqa: T201
    print(f"slowest {slowest[0]:.2f} s (seed {slowest[1]}), largest process {largest:.0f} MB")  # noqa: T201
    return 1 if outcomes["FAILED"] else 0


if __name__ == "__main__":
    sys.exit(main())
