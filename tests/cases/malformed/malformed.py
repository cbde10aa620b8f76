"""Every file of expected.txt through the program: its exit code, what it says, and no crash.

usage: malformed.py PROGRAM
"""
import os
import subprocess
import sys

FOLDER = os.path.dirname(os.path.abspath(__file__))
CRASH = ('Backtrace', 'backtrace', 'Fortran runtime', 'SIGSEGV', 'SIGFPE', 'AddressSanitizer', 'runtime error:')


def expectations():
    with open(os.path.join(FOLDER, 'expected.txt'), encoding='utf-8') as file:
        for line in file:
            line = line.rstrip('\n')
            if line and not line.startswith('#'):
                name, code, *texts = line.split(' | ')
                yield name, int(code), texts


def main():
    program = os.path.abspath(sys.argv[1])
    passed = failed = 0
    for name, code, texts in expectations():
        done = subprocess.run([program, name, '--check', '--quiet'], cwd=FOLDER, stdin=subprocess.DEVNULL,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=60)
        said = done.stderr.decode('utf-8', errors='replace')
        wrong = [f'does not say: {text}' for text in texts if text not in said]
        if done.returncode != code:
            wrong.append(f'exit code {done.returncode}, not {code}')
        if any(word in said for word in CRASH):
            wrong.append('crashed')
        if wrong:
            failed += 1
            print(f'FAILED: {name}: ' + '; '.join(wrong))
            print(said)
        else:
            passed += 1
    print(f'{passed} checks passed, {failed} failed')
    sys.exit(1 if failed or passed < 40 else 0)


main()
