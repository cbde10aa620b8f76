"""Costs of a build: seconds of compiling and linking, the slowest files, the largest procedures, and the sizes of programs.

usage: build_costs.py BUILD      a build folder made by ninja
"""
import os
import re
import subprocess
import sys

MOST = 8      # lines of each list


def steps_of(folder):
    """(seconds, output) of each step of the last time that it was made, from ninja's log."""
    last = {}
    with open(os.path.join(folder, '.ninja_log'), encoding='utf-8') as file:
        for line in file:
            fields = line.rstrip('\n').split('\t')
            if len(fields) >= 4:
                last[fields[3]] = (int(fields[1]) - int(fields[0])) / 1000
    return sorted(((seconds, output) for output, seconds in last.items()), reverse=True)


def procedures_of(program):
    """(bytes, name) of the procedures of the project in a program."""
    listed = subprocess.run(['nm', '-S', program], capture_output=True, text=True).stdout
    found = re.findall(r'^\S+ (\S+) [tT] __mech9_(\S+)$', listed, re.M)
    return sorted(((int(size, 16), name) for size, name in found), reverse=True)


def main():
    folder = sys.argv[1]
    steps = steps_of(folder)
    objects = [(seconds, output) for seconds, output in steps if output.endswith('.o')]
    links = [(seconds, output) for seconds, output in steps if re.match(r'bin/\w+', output) and not output.endswith('.o')]
    print(f'compiling {len(objects)} files: {sum(seconds for seconds, _ in objects):.0f} s of all cores together')
    for seconds, output in links:
        print(f'linking {output}: {seconds:.1f} s')
    for seconds, output in objects[:MOST]:
        print(f'  {seconds:5.1f} s  {re.sub(r".*[.]dir/", "", output)}')
    for program in ('mech9k', 'mech9d'):
        path = os.path.join(folder, 'bin', program)
        if os.path.exists(path):
            print(f'{program}: {os.path.getsize(path) / 1e6:.1f} MB')
    for size, name in procedures_of(os.path.join(folder, 'bin', 'mech9k'))[:MOST]:
        print(f'  {size / 1e3:5.0f} kB  {name}')


main()
