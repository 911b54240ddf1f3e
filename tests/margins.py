#!/usr/bin/env python3
"""Measures how far the bounds of the tests are from what they bound.

margins.py copy FROM TO        copies the tests; each comparison of numbers in an assertion then keeps its margin
margins.py list LEAST FILE...  lists the comparisons whose least margin in these files, one a run, is below LEAST and
                               whose values differ between the runs

A margin is the bound divided by the value where the value is to stay below, and the inverse where it is to stay above,
so that 1 is the edge. Comparisons with 0 and of numbers with different signs have none. A value that is as far from its
bound on all instruction sets, to a part SAME of that distance, does not depend on roundoff. `make margins` calls both.
"""
import os
import re
import shutil
import sys

ASSERTION = re.compile(r"\bck_assert(_msg|_(?:int|uint|double|ldouble)_(?:lt|le|gt|ge)|_(?:double|ldouble)_eq_tol)?\(")
SIGNS = {"lt": "<", "le": "<=", "gt": ">", "ge": ">="}
HEADER = "margins.h"
SAME = 0.1


def closing(text, at):
    """Returns the place of the bracket that closes the one at `at`, and those of the commas on its level."""
    level, commas, quote = 0, [], None
    while at < len(text):
        c = text[at]
        if quote:
            if c == "\\":
                at += 1
            elif c == quote:
                quote = None
        elif c in "\"'":
            quote = c
        elif c in "([{":
            level += 1
        elif c in ")]}":
            level -= 1
            if level == 0:
                return at, commas
        elif c == "," and level == 1:
            commas.append(at)
        at += 1
    raise ValueError("a bracket is not closed")


def split_outside(text, pattern):
    """Splits at the matches of a pattern that stand outside of brackets and strings."""
    parts, signs, start, at = [], [], 0, 0
    while at < len(text):
        if text[at] in "([{":
            at = closing(text, at)[0] + 1
            continue
        if text[at] in "\"'":
            end = at + 1
            while text[end] != text[at]:
                end += 2 if text[end] == "\\" else 1
            at = end + 1
            continue
        match = pattern.match(text, at)
        if match:
            parts.append(text[start:at])
            signs.append(match.group().strip())
            start = at = match.end()
        else:
            at += 1
    return parts + [text[start:]], signs


COMPARISON = re.compile(r"(?<![-<>=])(<=|>=|<(?![<=])|>(?![>=]))")


def compared(a, sign, b, place):
    return f'MARGIN({a.strip()}, {sign}, {b.strip()}, "{place}")'


def condition(text, place):
    """Keeps the margins of a condition that is one comparison or several with && between them."""
    if split_outside(text, re.compile(r"\|\||\?"))[1]:
        return text
    parts, _ = split_outside(text, re.compile(r"&&"))
    for i, part in enumerate(parts):
        sides, signs = split_outside(part, COMPARISON)
        if len(signs) == 1 and not split_outside(part, re.compile(r"==|!="))[1]:
            parts[i] = compared(sides[0], signs[0], sides[1], place)
    return " && ".join(parts)


def with_margins(text, name):
    out, done = [], 0
    for match in ASSERTION.finditer(text):
        if match.start() < done or text.rfind("#define", text.rfind("\n", 0, match.start()) + 1, match.start()) >= 0:
            continue
        end, commas = closing(text, match.end() - 1)
        edges = [match.end() - 1] + commas + [end]
        arguments = [text[a + 1 : b] for a, b in zip(edges, edges[1:])]
        place, kind = f"{name}:{text.count(chr(10), 0, match.start()) + 1}", match.group(1) or ""
        if kind in ("", "_msg"):
            new = [condition(arguments[0], place)] + arguments[1:]
            new = f"ck_assert{kind}(" + ",".join(new) + ")"
        elif kind.endswith("_eq_tol"):
            a, b, tolerance = arguments
            new = f"ck_assert({compared(f'MARGIN_DISTANCE({a}, {b})', '<=', tolerance, place)})"
        else:
            new = f"ck_assert({compared(arguments[0], SIGNS[kind[-2:]], arguments[1], place)})"
        # A statement that stood on several lines stands on the first of them, so that the numbers of lines stay.
        out += [text[done : match.start()], new.replace("\n", " "), "\n" * text.count("\n", match.start(), end + 1)]
        done = end + 1
    return "".join(out + [text[done:]])


def copy(source, target):
    shutil.rmtree(target, ignore_errors=True)
    shutil.copytree(source, target)
    for folder, _, names in os.walk(target):
        for name in names:
            path = os.path.join(folder, name)
            if not name.endswith((".c", ".h")) or name == HEADER:
                continue
            with open(path) as file:
                text = file.read()
            new = with_margins(text, os.path.relpath(path, os.path.dirname(target)))
            if new != text:
                first = new.find("#include")
                line = new.count("\n", 0, first) + 1
                with open(path, "w") as file:
                    file.write(new[:first] + f'#include "{HEADER}"\n#line {line}\n' + new[first:])


def margin(sign, value, bound):
    below = sign in ("<", "<=")
    return bound / value if below == (bound > 0) else value / bound


def read(name):
    """Returns the least margin of each comparison in a file of one run, with its value and its bound."""
    least = {}
    with open(name) as file:
        for line in file:
            place, text, sign, value, bound = line.rstrip("\n").split("\t")
            value, bound = float(value), float(bound)
            one = (margin(sign, value, bound), value, bound, os.path.basename(name))
            least[place, text] = min(least.get((place, text), one), one)
    return least


def report(least, names):
    found = {}
    for name in names:
        for site, one in read(name).items():
            found.setdefault(site, []).append(one)
    for (place, text), runs in sorted(found.items(), key=lambda item: min(item[1])):
        ratio, value, bound, name = min(runs)
        gaps = [abs(v - b) / abs(b) for _, v, b, _ in runs]
        spread = max(gaps) - min(gaps)
        if ratio < least and spread > SAME * min(gaps):
            print(f"{ratio:6.3f}  {place}: {text}  ({value:.6g} and {bound:.6g}, {name}; +-{spread:.1e})")


if __name__ == "__main__":
    if sys.argv[1] == "copy":
        copy(sys.argv[2], sys.argv[3])
    else:
        report(float(sys.argv[2]), sys.argv[3:])
