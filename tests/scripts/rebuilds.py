#!/usr/bin/env python3
"""Tells how many files of src each of the last commits rebuilds; people call it to find interfaces that cause long builds.

usage: rebuilds.py [--last N] [--replay M]      needs git; with --replay also gfortran and the Fortran modules of SUNDIALS and HDF5

Files are counted for each of the last N commits that change Fortran files of src (300 if it is not given):

  dependent  the changed files, and all files that depend on them through `use`, directly and through others

M of these commits, evenly spread, are replayed with gfortran -fsyntax-only, and two numbers more are counted for them:

  rebuilt    the changed files, and those that use a module whose .mod differs after the change. The build does so, for CMake
             copies a .mod only where it differs.
  necessary  of these, the files that would be rebuilt if a .mod counted as different only where its entries are, in any order

gfortran writes the bound procedures of a type in an order that depends on how many names it has read before the type. So a
.mod may differ because a module that its own module uses has one more name. A `use` statement inside a procedure, behind the
types, has no such effect.

A list of the modules follows for whose interfaces most files were rebuilt: the sum of these files, the commits in which the
interface changed, those among them in which the module's own file did not, but only modules that it uses, and those in which only
the order of entries did. Interrupting the replay (Ctrl-C) shows what was counted so far.
"""
import argparse
import collections
import gzip
import hashlib
import os
import re
import statistics
import subprocess
import tempfile

from floors import MODULE, USE
from mech9_cases import TREE

PARENT = re.compile(r'^\s*submodule\s*\(\s*(\w+)', re.I | re.M)
INCLUDED = re.compile(r"^\s*include\s*['\"]([^'\"]+)['\"]", re.I | re.M)
FOLDERS = ['/usr/include/sundials/fortran', '/usr/include/hdf5/serial']
SUNDIALS = '/usr/include/sundials/sundials_config.h'
COMPILE = ['gfortran', '-std=f2008', '-fimplicit-none', '-cpp', '-fsyntax-only', '-w']
# Names of modules for the templates `*.f90.in`, in a build without the optional libraries.
CHOICES = {'MECH9_EDITOR_MODULE': 'mech9_no_editor', 'MECH9_XML_MODULE': 'mech9_no_expat', 'MECH9_LIMITED_MODULE': 'mech9_no_nlopt'}


def git(*words, data=None):
    """The output of a command of git."""
    return subprocess.run(['git', '-C', TREE, *words], input=data, stdout=subprocess.PIPE, check=True).stdout


def choices():
    """CHOICES, and the module for the version of SUNDIALS that is installed."""
    try:
        with open(SUNDIALS, encoding='utf-8') as file:
            version = re.search(r'SUNDIALS_VERSION_MAJOR (\d+)', file.read())
    except OSError:
        version = None
    return dict(CHOICES, MECH9_SUNDIALS_MODULE=f'mech9_sundials_{version.group(1)}') if version else CHOICES


class Source:
    """A Fortran file: its text, the modules that it holds and uses, and the files that it includes."""

    def __init__(self, text):
        self.text = text
        self.modules = [name.lower() for name in MODULE.findall(text)]
        self.parents = {name.lower() for name in PARENT.findall(text)}
        self.used = {name.lower() for name, _ in USE.findall(text)} - set(self.modules)
        self.included = [os.path.basename(name) for name in INCLUDED.findall(text)]


class Sources:
    """The Fortran files of src in a commit, each read once."""

    def __init__(self):
        self.known = {}
        self.chosen = choices()

    def source(self, path, text):
        """The one source with this text."""
        key = (path.endswith('.in'), text)
        if key not in self.known:
            self.known[key] = Source(re.sub(r'@(\w+)@', lambda found: self.chosen.get(found.group(1), ''), text) if key[0] else text)
        return self.known[key]

    def of_commit(self, commit):
        """The source of each path."""
        rows = [row.split(None, 3) for row in git('ls-tree', '-r', commit, 'src').decode().splitlines()]
        rows = [(row[2], row[3]) for row in rows if row[3].endswith(('.f90', '.f90.in', '.inc'))]
        answer = git('cat-file', '--batch', data='\n'.join(blob for blob, _ in rows).encode())
        found, at = {}, 0
        for _, path in rows:
            end = answer.index(b'\n', at)
            length = int(answer[at:end].split()[2])
            found[path] = self.source(path, answer[end + 1:end + 1 + length].decode('utf-8', 'replace'))
            at = end + length + 2
        return found


def changed_files(before, after):
    """The paths whose text is new or another one; those that include such a file among them."""
    changed = {path for path in after if path not in before or before[path] is not after[path]}
    parts = {os.path.basename(path) for path in changed if path.endswith('.inc')}
    return {path for path in after if not path.endswith('.inc') and (path in changed or parts & set(after[path].included))}


def dependent_files(changed, files):
    """The changed files and all that depend on them."""
    users = collections.defaultdict(set)
    for path, source in files.items():
        for module in source.used | source.parents:
            users[module].add(path)
    reached, ahead = set(changed), list(changed)
    while ahead:
        for module in files[ahead.pop()].modules:
            new = users[module] - reached
            reached |= new
            ahead += new
    return reached


def digests(interface):
    """The digests of a .mod: of its text, which is compressed, and of its entries in any order, without the numbers that they get."""
    with gzip.open(interface) as file:
        text = file.read()
    entries = b' '.join(sorted(re.findall(rb"'[^']*'|[^\s()'\d][^\s()']*", text)))
    return hashlib.sha1(text).hexdigest(), hashlib.sha1(entries).hexdigest()


class Done:
    """The work of an update of the build."""

    def __init__(self):
        self.rebuilt = set()                              # paths of files
        self.necessary = set()                            # those that are rebuilt for more than the order of entries
        self.reasons = collections.defaultdict(set)       # for each interface, the unchanged files that were compiled for it
        self.changed = set()                              # names of interfaces that differ
        self.handed_on = set()                            # those whose own files did not change
        self.reordered = set()                            # those that differ in the order of entries only


class Build:
    """The build of src by gfortran -fsyntax-only: modules in one folder, and for each file from what it was compiled."""

    def __init__(self, folder):
        self.folder = folder
        self.new = os.path.join(folder, 'new')
        os.makedirs(self.new)
        self.interfaces = {}   # digest of each .mod and .smod, by the name of its file
        self.entries = {}      # digest of its entries, without their order
        self.compiled = {}     # by path: text, included texts, and the digests of the modules that are used
        self.failed = set()

    def order(self, files):
        """The paths, each after those of the modules that it uses."""
        home = {module: path for path, source in files.items() for module in source.modules}
        ordered, seen = [], set()
        def visit(path):
            if path in seen:
                return
            seen.add(path)
            for module in sorted(files[path].used | files[path].parents):
                if module in home:
                    visit(home[module])
            ordered.append(path)
        for path in sorted(files):
            if not path.endswith('.inc'):
                visit(path)
        return ordered

    def inputs(self, path, files):
        """All that a file is compiled from: its text, the included texts, and the digests of the interfaces that it reads."""
        source = files[path]
        parts = [files[other].text for other in sorted(files) if other.endswith('.inc') and os.path.basename(other) in source.included] \
            if source.included else []
        names = [f'{module}.mod' for module in source.used] + [f'{module}.smod' for module in source.parents]
        return source.text, parts, {name: self.interfaces[name] for name in names if name in self.interfaces}

    def compile(self, path, files):
        """Compile a file; the names of the interfaces that differ from before, and of those that differ in more than the order."""
        source = files[path]
        name = self.write(path[:-len('.in')] if path.endswith('.in') else path, source.text)
        for other in files:
            if other.endswith('.inc') and os.path.basename(other) in source.included:
                self.write(other, files[other].text)
        folders = [f'-J{self.new}'] + [f'-I{folder}' for folder in [self.folder] + FOLDERS]
        code = subprocess.run(COMPILE + folders + [name], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False).returncode
        os.remove(name)
        (self.failed.add if code else self.failed.discard)(path)
        changed, essential = set(), set()
        for made in os.listdir(self.new):
            here = os.path.join(self.new, made)
            digest, entries = digests(here)
            if self.entries.get(made) != entries:
                essential.add(made)
            if self.interfaces.get(made) != digest:
                changed.add(made)
            self.interfaces[made], self.entries[made] = digest, entries
            os.replace(here, os.path.join(self.folder, made))
        return changed, essential

    def write(self, path, text):
        """Write a source into the folder of the build; its name there."""
        name = os.path.join(self.folder, os.path.basename(path))
        with open(name, 'w', encoding='utf-8') as file:
            file.write(text)
        return name

    def update(self, files):
        """Build the files; the work that this took."""
        done = Done()
        for path in self.order(files):
            inputs, former = self.inputs(path, files), self.compiled.get(path)
            if inputs == former:
                continue
            is_same = former is not None and inputs[:2] == former[:2]
            if is_same:
                reasons = {name for name in inputs[2] if inputs[2][name] != former[2].get(name)}
                for name in reasons:
                    done.reasons[name].add(path)
            changed, essential = self.compile(path, files)
            done.changed |= changed
            done.handed_on |= changed if is_same else set()
            done.reordered |= changed - essential
            self.compiled[path] = inputs
            if path not in self.failed:
                done.rebuilt.add(path)
                if not is_same or reasons - done.reordered:
                    done.necessary.add(path)
        for path in set(self.compiled) - set(files):
            del self.compiled[path]
        return done


class Counts:
    """Sums over the commits so far."""

    def __init__(self):
        self.dependent = []
        self.replayed = []                                # dependent files of the commits that were replayed
        self.rebuilt = []
        self.necessary = []
        self.caused = collections.Counter()               # files rebuilt for an interface
        self.changed = collections.Counter()              # commits that changed it, and likewise of these
        self.handed_on = collections.Counter()
        self.reordered = collections.Counter()
        self.failed = set()

    def add(self, done):
        """Count the work of an update of the build."""
        self.rebuilt.append(len(done.rebuilt))
        self.necessary.append(len(done.necessary))
        self.caused.update({name: len(paths) for name, paths in done.reasons.items()})
        for sums, names in ((self.changed, done.changed), (self.handed_on, done.handed_on), (self.reordered, done.reordered)):
            sums.update(names)

    def print(self):
        for name, counts in (('dependent', self.dependent), ('replayed: dependent', self.replayed), ('replayed: rebuilt', self.rebuilt),
                             ('replayed: necessary', self.necessary)):
            if counts:
                counts = sorted(counts)
                print(f'{name:20} commits {len(counts):4}   median {statistics.median(counts):6.1f}   mean {statistics.mean(counts):6.1f}   '
                      f'nine tenths up to {counts[(len(counts) - 1)*9//10]:4}   most {counts[-1]:4}')
        if self.caused:
            print('\n rebuilt  changed  handed on  reordered')
            for name, count_of in self.caused.most_common(25):
                print(f'{count_of:8} {self.changed[name]:8} {self.handed_on[name]:10} {self.reordered[name]:10}   {name}')
        if self.failed:
            print('\nnot compiled here: ' + ' '.join(sorted(self.failed)))


def count(commits, replayed, counts):
    """Count for each commit, and print a row for it."""
    sources = Sources()
    with tempfile.TemporaryDirectory() as folder:
        build = Build(folder)
        for commit in commits:
            before, after = sources.of_commit(commit + '^'), sources.of_commit(commit)
            changed = changed_files(before, after)
            if not changed:
                continue
            dependent = len(dependent_files(changed, after))
            counts.dependent.append(dependent)
            row = f'{commit}  changed {len(changed):4}   dependent {dependent:4}'
            if commit in replayed:
                build.update(before)
                done = build.update(after)
                counts.replayed.append(dependent)
                counts.add(done)
                counts.failed |= build.failed
                row += f'   rebuilt {len(done.rebuilt):4}   necessary {len(done.necessary):4}'
            print(row + '   ' + git('log', '-1', '--format=%s', commit).decode().strip()[:72], flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('--last', type=int, default=300, metavar='N', help='commits that change src')
    parser.add_argument('--replay', type=int, default=0, metavar='M', help='of these are replayed by the compiler')
    options = parser.parse_args()
    commits = git('log', f'-{options.last}', '--reverse', '--format=%h', '--', 'src/*.f90', 'src/*.f90.in', 'src/*.inc').decode().split()
    replayed = set(commits[::max(1, len(commits)//options.replay)][:options.replay]) if options.replay else set()
    counts = Counts()
    try:
        count(commits, replayed, counts)
    except KeyboardInterrupt:
        pass
    counts.print()


if __name__ == '__main__':
    main()
