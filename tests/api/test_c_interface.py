"""The library for C and C++: what it shows, its header, and the programs of examples/c."""
import math
import os
import re
import shutil
import subprocess

import pytest

from mech9_cases import TREE, read_table, run, table_of, text_of, tolerance_of

HEADER = os.path.join(TREE, 'include', 'mech9.h')
FOLDER = os.path.join(TREE, 'examples', 'c')


@pytest.fixture(name='library')
def shared_library(build):
    path = os.path.join(build.folder, 'lib', 'libmech9.so.0')
    if not os.path.exists(path):
        pytest.skip('this build has no libmech9.so')
    return path


def declared_names():
    return {name for name in re.findall(r'\b(mech9_\w+)\(', text_of(HEADER)) if not name.endswith('_function')}


def compiled(build, library, source, tmp_path, compiler, *options):
    """The program of a source, linked with the library of the build."""
    if not shutil.which(compiler):
        pytest.skip(f'there is no {compiler}')
    program = tmp_path / os.path.basename(source).split('.')[0]
    sanitizers = ['-fsanitize=address,undefined'] if build.kind == 'Sanitize' else []
    folder = os.path.dirname(library)
    done = subprocess.run([compiler, '-Wall', '-Wextra', '-Wpedantic', '-Werror', *options, *sanitizers, '-I', os.path.dirname(HEADER),
                           source, '-o', str(program), library, f'-Wl,-rpath,{folder}', '-lm'], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return str(program)


def test_shown_names(checks, library):
    listed = subprocess.run(['nm', '-D', '--defined-only', library], capture_output=True, text=True, check=True).stdout
    shown = {line.split()[-1] for line in listed.splitlines()}
    checks.equal(sorted(shown), sorted(declared_names()), 'the library shows what its header declares, and nothing else')


def test_name_of_the_library(checks, build, library):
    described = subprocess.run(['objdump', '-p', library], capture_output=True, text=True, check=True).stdout
    checks.true('SONAME               libmech9.so.0\n' in described, 'the library bears its name and the number of its interface')
    needed = re.findall(r'NEEDED +(\S+)', described)
    # archives of a system cannot always go into a shared library (Debian 13)
    shared = ['libexpat'] if build.settings.get('MECH9_EXPAT', '').endswith('.so') else []
    shared += ['libsundials'] if any(name.startswith('MECH9_sundials') for name in build.settings) else []
    left_out = tuple(name for name in ('libhdf5', 'libedit', 'libsundials', 'libexpat') if name not in shared)
    checks.true(not any(name.startswith(left_out) for name in needed), f'it needs little: {needed}')


def test_program_in_c(checks, build, library, tmp_path):
    program = compiled(build, library, os.path.join(FOLDER, 'four_bar.c'), tmp_path, 'gcc', '-std=c99')
    done = run(program, folder=FOLDER)
    checks.equal(done.returncode, 0, f'it runs; {done.stderr}')
    lines = done.stdout.splitlines()
    checks.equal(len(lines), 14, 'a line for each output, and one for the motion')
    checks.true(lines[0].startswith('t = 0.00 s, q2 = '), f'names and units: {lines[0]}')
    failed = run(program, 'missing.nml', folder=FOLDER)
    checks.equal(failed.returncode, 8, 'a file that is not there is told by its exit code')
    checks.true('missing.nml: cannot be read: there is no such file' in failed.stderr, f'and in words: {failed.stderr}')


def test_program_in_cpp(checks, build, library, tmp_path):
    if build.kind == 'Debug':
        pytest.skip('the debug build checks recursion, which takes two threads in one procedure for one')
    program = compiled(build, library, os.path.join(FOLDER, 'many_positions.cpp'), tmp_path, 'g++', '-std=c++17', '-pthread')
    done = run(program, folder=FOLDER)
    checks.equal(done.returncode, 0, f'eight threads give the same bits; {done.stderr}')


MISUSE = r'''
#include <mech9.h>
#include <stdio.h>
#include <string.h>
static int failures = 0;
static void expect(int holds, const char *what) { if (!holds) { failures++; printf("%s\n", what); } }
static double last = -1;
static int told(double done, void *data) { last = done; return *(int *)data; }
int main(void)
{
  mech9_error *error = mech9_error_create();
  mech9_mechanism *mechanism = NULL, *copy = NULL;
  mech9_results *results = NULL;
  mech9_positions *positions = NULL;
  mech9_equations *equations = NULL;
  double value = 0, q[4], point[3] = {0, 0, 0}, state[2], rates[2];
  int stop = 1, codes[1];
  expect(mech9_kinematics(NULL, NULL, &results, error) == 2 && results == NULL, "no mechanism");
  expect(strstr(mech9_error_message(error), "this is no mechanism") != NULL, "no mechanism is told");
  expect(mech9_simulation_advance(NULL, 1.0, error) == 2, "no simulation");
  expect(mech9_results_rows(NULL) == 0 && mech9_results_data(NULL) == NULL && mech9_results_name(NULL, 0) == NULL, "no results");
  expect(mech9_read_text("&pair coordinate=1, links=1,2, kind='revolut' /\n&nothing /", &mechanism, error) == 3, "two errors");
  expect(mechanism == NULL && mech9_error_findings(error) == 2, "two errors are found");
  expect(mech9_error_finding_line(error, 0) == 1 && mech9_error_finding_column(error, 0) == 37, "the place of the first");
  expect(mech9_error_finding_line(error, 1) == 2 && mech9_error_finding_line(error, 2) == 0, "the place of the second");
  expect(mech9_error_finding_message(error, -1) == NULL && mech9_error_finding_file(error, 7) == NULL, "no other error");
  expect(mech9_read_text("", &mechanism, error) == 0 && mech9_error_code(error) == 0, "an empty mechanism");
  expect(mech9_check(mechanism, &results, error) != 0 && results == NULL, "has no structure");
  mech9_mechanism_destroy(mechanism);
  expect(mech9_import_file("missing.urdf", NULL, 0, &mechanism, error) != 0 && mechanism == NULL, "no robot");
  expect(mech9_import_file(NULL, NULL, 0, &mechanism, NULL) != 0 && mechanism == NULL, "no path");
  expect(mech9_read_file("four_bar.nml", &mechanism, NULL) == 0, "no handle of errors is needed");
  expect(mech9_mechanism_number(mechanism, "pair(2).point(1)", &value, error) == 0 && value == 0.3, "a number");
  expect(mech9_mechanism_number(mechanism, "pair(2).nothing", &value, error) == 3 && value != value, "no number");
  expect(mech9_mechanism_imported_text(mechanism) == NULL && mech9_mechanism_import_messages(NULL) == NULL, "no import");
  expect(mech9_mechanism_copy(mechanism, &copy, error) == 0, "a copy");
  expect(mech9_mechanism_set(copy, "pair(2).point(1)", 0.2, error) == 0, "is changed");
  expect(mech9_mechanism_number(mechanism, "pair(2).point(1)", &value, error) == 0 && value == 0.3, "without its original");
  expect(mech9_mechanism_apply(copy, "time.intervals=-1", error) == 3, "a setting out of its range is refused");
  expect(mech9_mechanism_add(copy, "&point name='Q', link=3 /", error) == 0, "a point is added");
  expect(strstr(mech9_mechanism_text(copy), "'Q'") != NULL, "and written");
  expect(mech9_kinematics(copy, &stop, &results, error) == 130, "a run that is to stop stops");
  mech9_results_destroy(results);
  stop = 0;
  expect(mech9_mechanism_use_progress(NULL, told, &stop, error) == 2, "progress of nothing");
  expect(mech9_mechanism_use_progress(copy, told, &stop, error) == 0, "a function for progress");
  expect(mech9_kinematics(copy, NULL, &results, error) == 0 && last == 1, "is told the end");
  mech9_results_destroy(results);
  expect(mech9_mechanism_apply(copy, "time.intervals=2000000", error) == 0, "a long run");
  stop = 1;
  last = -1;
  expect(mech9_kinematics(copy, NULL, &results, error) == 130 && last >= 0 && last < 0.9, "is stopped by the function");
  expect(results != NULL && mech9_results_rows(results) < 2000000, "before its end");
  expect(mech9_mechanism_use_progress(copy, NULL, NULL, error) == 0, "which is taken back");
  expect(mech9_mechanism_apply(copy, "time.intervals=12", error) == 0, "a short run");
  expect(mech9_results_data_set_kind(results, -1) == 0 && mech9_results_data_set_path(results, 100000) == NULL, "no such data set");
  mech9_results_destroy(results);
  expect(mech9_check(mechanism, &results, error) == 0 && mech9_results_lay_out(results, mechanism, error) == 2, "a check has no file");
  mech9_results_destroy(results);
  expect(mech9_mechanism_reads(mechanism, "./four_bar.nml") != NULL, "the data file is known");
  expect(mech9_mechanism_reads(mechanism, "other.nml") == NULL && mech9_mechanism_reads(NULL, "a") == NULL, "no other file is");
  expect(mech9_kinematics(mechanism, NULL, &results, error) == 0 && mech9_results_data_sets(results) == 0, "a run");
  expect(mech9_results_lay_out(results, NULL, error) == 2 && mech9_results_lay_out(NULL, mechanism, error) == 2, "of no mechanism");
  expect(mech9_results_lay_out(results, mechanism, error) == 0 && mech9_results_data_sets(results) > 30, "has data sets");
  for (int i = 0; i < mech9_results_data_sets(results); i++) {
    int steps = mech9_results_data_set_rank(results, i) > 0 ? mech9_results_data_set_extent(results, i, 0) : 1;
    if (strcmp(mech9_results_data_set_path(results, i), "position") == 0) {
      expect(mech9_results_data_set_kind(results, i) == 1 && mech9_results_data_set_rank(results, i) == 3, "numbers over three dimensions");
      expect(strcmp(mech9_results_data_set_scale(results, i, 1), "point") == 0, "with scales");
      expect(mech9_results_data_set_take(results, i, 12, 1, point, error) == 0 && point[0] != 0, "the last row");
      expect(mech9_results_data_set_take(results, i, 12, 2, point, error) == 2, "none behind it");
    }
    if (strcmp(mech9_results_data_set_path(results, i), "diagnostics/exit_code") == 0)
      expect(mech9_results_data_set_take(results, i, 0, 1, codes, error) == 0 && codes[0] == 0, "a single whole number");
    if (mech9_results_data_set_kind(results, i) == 4)
      expect(mech9_results_data_set_text(results, i, 0) != NULL && mech9_results_data_set_take(results, i, 0, 1, q, error) == 2, "texts");
    expect(mech9_results_data_set_take(results, i, 0, steps + 1, q, error) == 2, "too many rows");
    expect(mech9_results_data_set_take(results, i, 2147483647, 1, q, error) == 2, "rows far behind");
  }
  expect(mech9_results_attribute_text(results, mech9_results_attributes(results)) == NULL, "no other attribute");
  mech9_results_destroy(results);
  expect(mech9_positions_create(mechanism, &positions, error) == 0, "positions");
  expect(mech9_positions_find(positions, 1, NULL, NULL, NULL, NULL, q, NULL, NULL, codes, error) == 2, "need values");
  expect(mech9_positions_find(positions, 0, &value, NULL, NULL, NULL, q, NULL, NULL, codes, error) == 0, "there may be none");
  mech9_positions_destroy(positions);
  expect(mech9_equations_create(mechanism, NULL, 0, &equations, error) == 3 && equations == NULL, "no equations where all is driven");
  expect(mech9_equations_create(NULL, NULL, 0, &equations, error) == 2 && mech9_equations_states(NULL) == 0, "of no mechanism");
  expect(mech9_mechanism_remove(copy, "drive", error) == 0 && mech9_mechanism_add(copy, "&body link=3, mass=2, centre=0.2,0,0 /"
         " &parameter name='g', sets='body(1).mass', value=2 / &initial coordinate=1, position=1 /", error) == 0, "a free mechanism");
  expect(mech9_equations_create(copy, NULL, 0, &equations, error) == 0 && mech9_equations_states(equations) == 2, "equations");
  expect(mech9_equations_parameters(equations) == 1 && strcmp(mech9_equations_name(equations, 2), "g") == 0, "with a parameter");
  expect(strcmp(mech9_equations_unit(equations, 1), "rad/s") == 0 && mech9_equations_name(equations, 3) == NULL, "and units");
  expect(mech9_equations_start(equations, state, &value, error) == 0 && state[0] == 1 && value == 2, "their start");
  expect(mech9_equations_find(equations, 0, state, &value, rates, NULL, NULL, error) == 0 && rates[0] == state[1], "the rates");
  expect(mech9_equations_find(equations, 0, state, &value, rates, q, point, error) == 0 && q[0] == 0 && q[1] == 1 && point[0] == 0,
         "and their derivatives, row by row");
  expect(mech9_equations_find(equations, 0, NULL, &value, rates, NULL, NULL, error) == 2, "of no state");
  mech9_equations_destroy(equations);
  mech9_equations_destroy(NULL);
  mech9_mechanism_destroy(copy);
  mech9_mechanism_destroy(mechanism);
  mech9_mechanism_destroy(NULL);
  mech9_results_destroy(NULL);
  mech9_positions_destroy(NULL);
  mech9_simulation_destroy(NULL);
  mech9_error_destroy(error);
  mech9_error_destroy(NULL);
  return failures;
}
'''


def test_wrong_use(checks, build, library, tmp_path):
    source = tmp_path / 'misuse.c'
    source.write_text(MISUSE)
    program = compiled(build, library, str(source), tmp_path, 'gcc', '-std=c99')
    done = run(program, folder=FOLDER)
    checks.equal((done.returncode, done.stdout), (0, ''), f'wrong calls are told, and nothing else is printed; {done.stderr}')


def test_own_force_in_c(checks, build, library, tmp_path):
    done = run(compiled(build, library, os.path.join(FOLDER, 'air_drag.c'), tmp_path, 'gcc', '-std=c99'))
    checks.equal(done.returncode, 0, f'it runs; {done.stderr}')
    speeds = [float(line.split()[-2]) for line in done.stdout.splitlines()]
    final = (2*9.81/0.1)**0.5
    # the tolerances of a run that names none are 1e-8
    checks.near(speeds, [final*math.tanh(9.81*t/final) for t in range(6)], 2e-6, 'the weight falls towards its final speed')


@pytest.fixture(name='with_procedures')
def program_with_user_procedures(build, library, tmp_path):
    """A function that makes a run of a sample of user_procs with functions of C of a form."""
    program = compiled(build, library, os.path.join(TREE, 'tests', 'api', 'user_procedures.c'), tmp_path, 'gcc', '-std=c99')
    return lambda sample, form: run(program, sample, os.path.join(TREE, 'user_procs', sample, sample + '.nml'), form, folder=tmp_path)


@pytest.mark.parametrize('sample', ('trammel', 'cycloidal_drive', 'cardan_coupling', 'air_drag'))
def test_user_procedures(checks, build, with_procedures, sample):
    """Functions of C and linked procedures in Fortran, which closed forms are held against elsewhere, give the same motion."""
    linked = table_of(build.program(sample + ('_d' if sample == 'air_drag' else '_k')),
                      os.path.join(TREE, 'user_procs', sample, sample + '.nml'))
    for form in ('exact', 'values'):
        done = with_procedures(sample, form)
        checks.equal(done.returncode, 0, f'{sample}, {form}: it runs; {done.stderr}')
        table = read_table(done.stdout)
        for column in linked:
            if column != 'closure':
                # motions under forces agree to their tolerances of 1e-10, which drag makes smaller
                limit = 1e-9 if sample == 'air_drag' else tolerance_of(column)
                checks.near(table[column], linked[column], limit, f'{sample}, {form}: {column}')


@pytest.mark.parametrize('sample, form, code, told', (
    ('trammel', 'failing', 3, 'the user procedure of pair 1 gives numbers that are not finite at q = 0.3'),
    ('trammel', 'none', 3, 'asks for a user procedure, but none is linked'),
    ('cycloidal_drive', 'failing', 3, 'the user procedure of the drive of coordinate 4 gives numbers that are not finite at t = 0'),
    ('cardan_coupling', 'failing', 3, 'the user procedure of coupling 1 gives numbers that are not finite'),
    ('air_drag', 'failing', 3, 'the user procedure for forces says that it has no forces at t = 0'),
    ('air_drag', 'wrong', 3, 'the user procedure for forces calls add_force with link 40, but the links of this mechanism are 1 to 3')))
def test_failing_user_procedures(checks, with_procedures, sample, form, code, told):
    done = with_procedures(sample, form)
    checks.equal(done.returncode, code, f'{sample}, {form}: it fails; {done.stderr}')
    checks.true(told in done.stderr, f'{sample}, {form}: it is told: {done.stderr}')
    checks.true(f'{sample}.nml:' in done.stderr, f'{sample}, {form}: with its place: {done.stderr}')
