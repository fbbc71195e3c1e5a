"""RAPID literals as nested lists of texts, to reach one element of an array.

Invariant: joining what was split gives the same literal without spaces.
"""

from __future__ import annotations

from collections.abc import Sequence

Tree = str | list["Tree"]


def split(literal: str) -> Tree:
    """Gives `[1,[2,"a,b"]]` as nested lists. Raises ValueError where brackets do not match."""
    stack: list[list[Tree]] = [[]]
    word, quoted = "", False
    for char in literal:
        if quoted or char == '"':
            word += char
            quoted = quoted != (char == '"')
        elif char == "[":
            stack.append([])
        elif char in ",]":
            if word.strip():
                stack[-1].append(word.strip())
            word = ""
            if char == "]":
                if len(stack) < 2:
                    raise ValueError(f"unmatched ] in {literal!r}")
                closed = stack.pop()
                stack[-1].append(closed)
        else:
            word += char
    if word.strip():
        stack[-1].append(word.strip())
    if len(stack) != 1 or len(stack[0]) != 1:
        raise ValueError(f"{literal!r} is no literal")
    return stack[0][0]


def join(tree: Tree) -> str:
    """Gives nested lists as a literal."""
    return tree if isinstance(tree, str) else "[" + ",".join(join(item) for item in tree) + "]"


def element(tree: Tree, indices: Sequence[int]) -> Tree:
    """Gives the element at 1-based indices. Raises ValueError where there is none."""
    for index in indices:
        if isinstance(tree, str) or not 1 <= index <= len(tree):
            raise ValueError(f"no element {index}")
        tree = tree[index - 1]
    return tree


def with_element(tree: Tree, indices: Sequence[int], value: Tree) -> Tree:
    """Gives a tree with another element at 1-based indices. Raises ValueError where there is none."""
    if not indices:
        return value
    element(tree, indices)
    place = indices[0] - 1
    return [with_element(item, indices[1:], value) if at == place else item for at, item in enumerate(tree)]


def numbers(tree: Tree) -> list[float]:
    """Gives all numbers of a tree in order. Raises ValueError where something else is in it."""
    return [float(tree)] if isinstance(tree, str) else [value for item in tree for value in numbers(item)]
