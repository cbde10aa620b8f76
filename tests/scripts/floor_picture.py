#!/usr/bin/env python3
"""Draws the floors of src and which floor uses which, from the `use` statements, in docs/pictures.

usage: floor_picture.py      needs Graphviz (dot). A test tells when the drawing is out of date: tests/tree/test_floor_picture.py

An arrow leads from a floor to one that it uses. Arrows that follow from two others are left out (a transitive
reduction), so that the order can be seen. Sub-floors, that is, folders of one folder, stand in a common box.
"""
import html
import os
import re
import subprocess

from floors import FLOORS, sources, used_floors
from mech9_cases import TREE, text_of

DRAWING = os.path.join(TREE, 'docs', 'pictures', 'architecture.dot')
PICTURE = os.path.join(TREE, 'docs', 'pictures', 'architecture.svg')
HEAD = '''// Made by tests/scripts/floor_picture.py from the use statements in src; do not edit.
digraph floors {
  rankdir=TB; nodesep=0.3; ranksep=0.35; newrank=true
  graph [fontname="sans-serif", fontsize=12, fontcolor="#555555", style="rounded,filled", color="#bbbbbb", fillcolor="#f4f4f4"]
  node [shape=box, style="rounded,filled", fillcolor="white", color="#335577", fontname="sans-serif", fontsize=13, height=0.35]
  edge [color="#335577", arrowsize=0.6]
'''


def reduced(uses):
    """The arrows that no way through other floors replaces."""
    def reached(floor, seen):
        for below in uses.get(floor, ()):
            if below not in seen:
                seen.add(below)
                reached(below, seen)
        return seen
    return {floor: {below for below in of if not any(below in reached(other, set()) for other in of - {below})}
            for floor, of in uses.items()}


def drawing(found):
    """The text of the drawing in the language of Graphviz, for the sources (floor, path, text) of src."""
    uses = reduced(used_floors(found))
    folders = []
    for floor in FLOORS[::-1]:
        folder = floor.split('/')[0]
        if folder not in folders:
            folders.append(folder)
    lines = []
    for folder in folders:
        floors = [floor for floor in FLOORS[::-1] if floor.split('/')[0] == folder]
        if len(floors) == 1:
            lines.append(f'  "{folder}"')
            continue
        lines.append(f'  subgraph "cluster_{folder}" {{')
        lines.append(f'    label="{folder}"')
        lines += [f'    "{floor}"' for floor in floors]
        lines.append('  }')
    for floor in FLOORS[::-1]:
        lines += [f'  "{floor}" -> "{below}"' for below in sorted(uses.get(floor, ()))]
    return HEAD + '\n'.join(lines) + '\n}\n'


def arrows_of_drawing(text):
    """The arrows in the text of a drawing, as pairs of floors."""
    return sorted(re.findall(r'^  "(.+)" -> "(.+)"$', text, re.M))


def arrows_of_picture(path):
    """The arrows of the picture that dot made: it names each by its ends."""
    titles = [html.unescape(title) for title in re.findall(r'<title>(.*?)</title>', text_of(path))]
    return sorted(tuple(title.split('->')) for title in titles if '->' in title)


def main():
    with open(DRAWING, 'w', encoding='utf-8') as file:
        file.write(drawing(list(sources())))
    subprocess.run(['dot', '-Tsvg', '-o', PICTURE, DRAWING], check=True)


if __name__ == '__main__':
    main()
