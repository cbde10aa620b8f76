/* MECH9: kinematic and dynamic analysis of spatial mechanisms with closed chains, for C and C++.
 *
 * A mechanism is read from a data file or a text of the same form. Numbers are in the units of the data file.
 *
 * Functions that can fail return 0, or the exit code of the programs: 2 usage, 3 data, 4 structure, 5 assembly,
 * 6 singular position, 7 integration, 8 file, 130 stopped by the caller. They tell the failure to the error handle,
 * which may be null. Nothing is printed. The process is not ended, but where the memory does not suffice.
 *
 * Do not use a handle after it was destroyed. Texts that a handle returns hold until the next call with this handle. Texts are
 * UTF-8. Positions in lists begin with 0.
 * Threads may use different handles at the same time.
 */
#ifndef MECH9_H
#define MECH9_H

#ifdef __cplusplus
extern "C" {
#endif

typedef struct mech9_error mech9_error;
typedef struct mech9_mechanism mech9_mechanism;
typedef struct mech9_results mech9_results;
typedef struct mech9_positions mech9_positions;
typedef struct mech9_equations mech9_equations;
typedef struct mech9_simulation mech9_simulation;
typedef struct mech9_motion mech9_motion;
typedef struct mech9_loads mech9_loads;

/* The version as one number: 10000 times the major number, 100 times the minor number, and the patch. */
int mech9_version(void);

/* Errors. A handle holds the failure of the last call that took it. */
mech9_error *mech9_error_create(void);
void mech9_error_destroy(mech9_error *error);
int mech9_error_code(const mech9_error *error);              /* 0: the call was successful */
const char *mech9_error_message(const mech9_error *error);   /* as the programs print it, with places and remedies */
int mech9_error_findings(const mech9_error *error);          /* how many errors were found together */
const char *mech9_error_finding_message(const mech9_error *error, int i);
const char *mech9_error_finding_file(const mech9_error *error, int i);   /* empty: it is in no file */
int mech9_error_finding_line(const mech9_error *error, int i);           /* from 1; 0: no place is known */
int mech9_error_finding_column(const mech9_error *error, int i);         /* from 1; 0: no place is known */

/* Mechanisms. Each group is held against the grammar when it comes; its sense beside the others is judged by an analysis. */
int mech9_read_file(const char *path, mech9_mechanism **mechanism, mech9_error *error);
int mech9_read_text(const char *groups, mech9_mechanism **mechanism, mech9_error *error);   /* "" makes an empty one */
/* Import a robot from a file in URDF, MJCF or SDF, as the option --import; `loops` is a file of <loop> elements for URDF, or null.
 * with_forces 0: a drive holds each independent coordinate, as by mech9k; else there are no drives, as by mech9d. Import in one
 * thread at a time. */
int mech9_import_file(const char *path, const char *loops, int with_forces, mech9_mechanism **mechanism, mech9_error *error);
/* Its data file as it was imported, with comments; and a line for each kind of thing that is not taken over, the last line being a
 * summary. Null for other mechanisms. */
const char *mech9_mechanism_imported_text(const mech9_mechanism *mechanism);
const char *mech9_mechanism_import_messages(const mech9_mechanism *mechanism);
int mech9_mechanism_copy(const mech9_mechanism *mechanism, mech9_mechanism **copy, mech9_error *error);
void mech9_mechanism_destroy(mech9_mechanism *mechanism);
/* Add groups, written as in a data file. */
int mech9_mechanism_add(mech9_mechanism *mechanism, const char *groups, mech9_error *error);
/* Remove all groups of a name, as "drive"; there may be none. */
int mech9_mechanism_remove(mech9_mechanism *mechanism, const char *name, mech9_error *error);
/* Give names other values, as the option --set does: "time.end=2", "pair(3).axis=1,0,0". */
int mech9_mechanism_apply(mech9_mechanism *mechanism, const char *setting, mech9_error *error);
/* A number by its name: "pair(2).point(1)". */
int mech9_mechanism_set(mech9_mechanism *mechanism, const char *name, double value, mech9_error *error);
int mech9_mechanism_number(const mech9_mechanism *mechanism, const char *name, double *value, mech9_error *error);
/* The text of a data file that makes the same mechanism. */
const char *mech9_mechanism_text(mech9_mechanism *mechanism);
/* The data file, or a file that its groups name, where a path means it, and null for all other paths: who writes a file asks first. */
const char *mech9_mechanism_reads(mech9_mechanism *mechanism, const char *path);
/* Names of the parameters. */
int mech9_mechanism_parameters(const mech9_mechanism *mechanism);
const char *mech9_mechanism_parameter(mech9_mechanism *mechanism, int i);
/* Whether drives move all independent coordinates. */
int mech9_mechanism_is_driven(const mech9_mechanism *mechanism, int *driven, mech9_error *error);

/* User procedures: functions that are called for all groups with kind='user', in place of Fortran procedures that are linked. A
 * copy of the mechanism has them, too. They return 0, or another number where they have no values. `parameters` are those of the
 * group &user, in number `n`. `data` is what was registered with the function. Studies and searches with several threads call them
 * in several threads at the same time. Null takes a function back.
 * Leave the derivatives as they are where they are not known: they are then found by differences, at 18 or more calls, up to 1 s, rad
 * or m away. Functions with kinks must give them. A function must not change the simulation that calls it. */
/* Three points of the moving link in the system of its reference link, not on a line [m]: origin, a point on the x axis, a third
 * one. points[0] has the points (y is along (r2 - r1) x (r3 - r1)), points[1] and points[2] their first and second derivatives by q. */
typedef int mech9_pair_function(int coordinate, double q, int n, const double *parameters, double points[3][3][3], void *data);
/* A coordinate and its derivatives by t [rad, m]. */
typedef int mech9_drive_function(int coordinate, double t, int n, const double *parameters, double values[3], void *data);
/* The second coordinate of a coupling and its derivatives by the first one [rad, m]. Couplings count from 1. */
typedef int mech9_coupling_function(int coupling, double first, int n, const double *parameters, double values[3], void *data);
/* Forces: they are added to `loads`. */
typedef int mech9_force_function(double t, const mech9_motion *motion, int n, const double *parameters, mech9_loads *loads,
                                 void *data);
int mech9_mechanism_use_pair(mech9_mechanism *mechanism, mech9_pair_function *function, void *data, mech9_error *error);
int mech9_mechanism_use_drive(mech9_mechanism *mechanism, mech9_drive_function *function, void *data, mech9_error *error);
int mech9_mechanism_use_coupling(mech9_mechanism *mechanism, mech9_coupling_function *function, void *data, mech9_error *error);
int mech9_mechanism_use_force(mech9_mechanism *mechanism, mech9_force_function *function, void *data, mech9_error *error);
/* A function that learns how far mech9_kinematics, _dynamics, _study and _optimize are: it is called in the thread of such a call,
 * about ten times a second, and at its end with 1. Another answer than 0 stops the call with code 130. Null takes it back. Copies of
 * the mechanism do not have it. */
typedef int mech9_progress_function(double done, void *data);   /* from 0 to 1 */
int mech9_mechanism_use_progress(mech9_mechanism *mechanism, mech9_progress_function *function, void *data, mech9_error *error);
/* For forces, within a call. Links and coordinates have their numbers, from 1. Points and vectors have three numbers: points and
 * directions that are given in the system of the link, all else along the axes of link 1. SI units. A number that does not exist
 * gives zeros, and ends the analysis. */
void mech9_motion_position(const mech9_motion *motion, int link, const double *point, double *position);
void mech9_motion_velocity(const mech9_motion *motion, int link, const double *point, double *velocity);
void mech9_motion_turned(const mech9_motion *motion, int link, const double *direction, double *turned);
void mech9_motion_angular_velocity(const mech9_motion *motion, int link, double *angular_velocity);
double mech9_motion_q(const mech9_motion *motion, int coordinate);
double mech9_motion_dq(const mech9_motion *motion, int coordinate);
void mech9_loads_add_force(mech9_loads *loads, const mech9_motion *motion, int link, const double *point, const double *force);
void mech9_loads_add_torque(mech9_loads *loads, int link, const double *torque);
void mech9_loads_add_generalized(mech9_loads *loads, int coordinate, double value);

/* Results: a table with named columns, and numbers with names of their own. */
void mech9_results_destroy(mech9_results *results);
int mech9_results_columns(const mech9_results *results);
int mech9_results_rows(const mech9_results *results);
const double *mech9_results_data(const mech9_results *results);   /* row after row */
const char *mech9_results_name(const mech9_results *results, int column);
const char *mech9_results_unit(const mech9_results *results, int column);
int mech9_results_numbers(const mech9_results *results);
const char *mech9_results_number_name(const mech9_results *results, int i);
const char *mech9_results_number_unit(const mech9_results *results, int i);
double mech9_results_number(const mech9_results *results, int i);
int mech9_results_parameters(const mech9_results *results);       /* 0: no derivatives */
/* Parameters come in the order of mech9_mechanism_parameter. */
double mech9_results_derivative(const mech9_results *results, int i, int parameter);
/* The report: of a run and a cam as JSON, as the option --report writes it, of a check in words; of ranges, assemblies, equilibria and
 * modes the names of links and coordinates, of ranges what limits each, as JSON; null: there is none. That of a run with &output
 * reactions may call user procedures. */
const char *mech9_results_text(mech9_results *results);
/* Matrices, with names and units for their rows and columns. */
int mech9_results_matrices(const mech9_results *results);
const char *mech9_results_matrix_name(const mech9_results *results, int i);
int mech9_results_matrix_rows(const mech9_results *results, int i);
int mech9_results_matrix_columns(const mech9_results *results, int i);
const double *mech9_results_matrix_data(const mech9_results *results, int i);   /* row after row */
const char *mech9_results_matrix_row_name(const mech9_results *results, int i, int row);
const char *mech9_results_matrix_row_unit(const mech9_results *results, int i, int row);
const char *mech9_results_matrix_column_name(const mech9_results *results, int i, int column);
const char *mech9_results_matrix_column_unit(const mech9_results *results, int i, int column);

/* The HDF5 file of a run, as the programs write it (docs/reference/results.md), for who writes files: data sets and attributes in the
 * order in which they are made. `mechanism` is that of the run, as it was then: its text becomes a data set. Paths have no slash at
 * their beginning; missing groups of a path are made. */
int mech9_results_lay_out(mech9_results *results, const mech9_mechanism *mechanism, mech9_error *error);
int mech9_results_data_sets(const mech9_results *results);                      /* 0 before mech9_results_lay_out */
const char *mech9_results_data_set_path(mech9_results *results, int i);
int mech9_results_data_set_kind(const mech9_results *results, int i);           /* 1 double, 2 int32_t, 3 int64_t, 4 text of any length */
int mech9_results_data_set_rank(const mech9_results *results, int i);           /* 0: a single value */
int mech9_results_data_set_extent(const mech9_results *results, int i, int dimension);   /* the slowest dimension first */
/* Rows of a chunk, where the data set can grow along its slowest dimension, whose steps are its rows; 0: it cannot. */
int mech9_results_data_set_chunk(const mech9_results *results, int i);
int mech9_results_data_set_compression(const mech9_results *results, int i);    /* 0 none, to 9: shuffled and deflated */
int mech9_results_data_set_is_scale(const mech9_results *results, int i);       /* a dimension scale with the last word of its path */
const char *mech9_results_data_set_scale(mech9_results *results, int i, int dimension);  /* path; null: none is attached */
const char *mech9_results_data_set_text(mech9_results *results, int i, int k);  /* of kind 4 */
/* Numbers of n rows from `first` on, in the kind of the data set; of a single value first = 0, n = 1. */
int mech9_results_data_set_take(const mech9_results *results, int i, int first, int n, void *numbers, mech9_error *error);
int mech9_results_attributes(const mech9_results *results);                     /* texts */
const char *mech9_results_attribute_path(mech9_results *results, int i);        /* of the data set or group; empty: of the file */
const char *mech9_results_attribute_name(mech9_results *results, int i);
const char *mech9_results_attribute_text(mech9_results *results, int i);

/* Analyses. `stop` is null, or the address of a number that stops the call soon after another thread or a signal handler
 * makes it other than 0. Results may be there after a failure: what was computed before it. */
int mech9_check(const mech9_mechanism *mechanism, mech9_results **results, mech9_error *error);   /* mobility, redundant, text */
int mech9_kinematics(const mech9_mechanism *mechanism, const volatile int *stop, mech9_results **results, mech9_error *error);
int mech9_dynamics(const mech9_mechanism *mechanism, const volatile int *stop, mech9_results **results, mech9_error *error);
/* A run over one period of a periodic motion, which is found first; the report of the results tells period and multipliers. */
int mech9_periodic(const mech9_mechanism *mechanism, const volatile int *stop, mech9_results **results, mech9_error *error);
int mech9_equilibrium(const mech9_mechanism *mechanism, int starts, const volatile int *stop, mech9_results **results,
                      mech9_error *error);
int mech9_modes(const mech9_mechanism *mechanism, mech9_results **results, mech9_error *error);
int mech9_assemblies(const mech9_mechanism *mechanism, int starts, const volatile int *stop, mech9_results **results,
                     mech9_error *error);
int mech9_range(const mech9_mechanism *mechanism, const volatile int *stop, mech9_results **results, mech9_error *error);
/* Lyapunov exponents, as many as are asked for: the numbers L1, L2, ..., their standard errors L1.error, ..., what they changed by in the
   second half of the time, L1.change, ..., and the mean divergence (not a number unless all exponents are asked for); a row for each time
   of the running means. An interrupted call has the results up to there. */
int mech9_exponents(const mech9_mechanism *mechanism, int count, const volatile int *stop, mech9_results **results,
                    mech9_error *error);
/* Branches of positions over the parameter of this name, of rest where with_forces is not 0: a row for each point, with the columns of
   --branch, and their part of a report as text. */
int mech9_branch(const mech9_mechanism *mechanism, const char *parameter, int with_forces, const volatile int *stop,
                 mech9_results **results, mech9_error *error);
/* The profile of a cam, from 1 in the order of its groups: a row for each output, and its entry in a report as text. */
int mech9_cam(const mech9_mechanism *mechanism, int number, mech9_results **results, mech9_error *error);
int mech9_study(const mech9_mechanism *mechanism, int with_forces, int threads, const volatile int *stop,
                mech9_results **results, mech9_error *error);
/* Matrices second_order/M, C, K and state_space/A, B, C, D; a row with the coordinates in equilibrium. */
int mech9_linear(const mech9_mechanism *mechanism, mech9_results **results, mech9_error *error);
/* The same along the motion under forces, at times in its order; no times: at all outputs. A row for each time with t, q, dq and ddq,
   and the matrices with the number of the time, from 0, before their names: 0/second_order/M. */
int mech9_linear_at(const mech9_mechanism *mechanism, int count, const double *times, const volatile int *stop,
                    mech9_results **results, mech9_error *error);
/* A row for each distinct design, best first: value, parameters, coordinates at the start, starts that led to it. */
int mech9_optimize(const mech9_mechanism *mechanism, int with_forces, int threads, const volatile int *stop,
                   mech9_results **results, mech9_error *error);
/* The mechanism of a design: parameters and coordinates as in its row. */
int mech9_mechanism_design(const mech9_mechanism *mechanism, int with_forces, const double *parameters, const double *q,
                           mech9_mechanism **design, mech9_error *error);
/* Pictures in files. The view is that of the option --view; null: the best one. */
int mech9_sketch(const mech9_mechanism *mechanism, const char *path, const char *view, mech9_error *error);
int mech9_animate(const mech9_mechanism *mechanism, int with_forces, const char *path, const char *view, const volatile int *stop,
                  mech9_error *error);

/* Positions for given values of the independent coordinates. Each is reached from the assembled start on a straight line, so
 * that none depends on the others. Arrays have a row for each position: I independent coordinates, or all M. */
int mech9_positions_create(const mech9_mechanism *mechanism, mech9_positions **positions, mech9_error *error);
void mech9_positions_destroy(mech9_positions *positions);
int mech9_positions_coordinates(const mech9_positions *positions);                /* M */
int mech9_positions_independent(const mech9_positions *positions);                /* I */
int mech9_positions_independent_at(const mech9_positions *positions, int i);      /* number of the coordinate, from 1 */
/* Rates and accelerations are found where their arrays are given. codes[n]: 0, or why a position was not reached; 6 also where it is
 * singular, so that rates of several independent coordinates do not determine the others. */
int mech9_positions_find(mech9_positions *positions, int n, const double *values, const double *rates,
                         const double *accelerations, const volatile int *stop, double *q, double *dq, double *ddq, int *codes,
                         mech9_error *error);

/* Equations of motion as a function of state, parameters and time, for other programs that integrate them or follow their solutions:
 * x' = f(x, p, t). The state has the free coordinates, then their rates, in SI units. The parameters are those of the groups &parameter,
 * in the units of the data file. `q` has all coordinates of a closed position [rad, m], or is null for the assembled start. Closed
 * chains follow the state from call to call. With a clock the state ends with cosine and sine of the phase of all drives and loads, in
 * place of the time. Refused are friction, contacts, rigid stops, and motors with states. */
int mech9_equations_create(const mech9_mechanism *mechanism, const double *q, int with_clock, mech9_equations **equations,
                           mech9_error *error);
void mech9_equations_destroy(mech9_equations *equations);
int mech9_equations_states(const mech9_equations *equations);
int mech9_equations_parameters(const mech9_equations *equations);
const char *mech9_equations_name(mech9_equations *equations, int i);      /* of the states, then of the parameters */
const char *mech9_equations_unit(mech9_equations *equations, int i);
int mech9_equations_start(const mech9_equations *equations, double *x, double *parameters, mech9_error *error);
/* Derivatives by_state[states][states] and by_parameters[states][parameters], a row for each rate; null leaves one out. Those by the
 * clock come from differences in time, to about 1e-10; all others are exact. */
int mech9_equations_find(mech9_equations *equations, double t, const double *x, const double *parameters, double *f,
                         double *by_state, double *by_parameters, mech9_error *error);

/* A motion that the caller advances; `stop` must outlive it. with_forces 0: driven, as by mech9k; else under forces, as by
 * mech9d. */
int mech9_simulation_create(const mech9_mechanism *mechanism, int with_forces, const volatile int *stop,
                            mech9_simulation **simulation, mech9_error *error);
void mech9_simulation_destroy(mech9_simulation *simulation);
int mech9_simulation_advance(mech9_simulation *simulation, double t, mech9_error *error);
double mech9_simulation_time(const mech9_simulation *simulation);
int mech9_simulation_coordinates(const mech9_simulation *simulation);
/* Coordinates, rates and second derivatives; null leaves one out. */
int mech9_simulation_take(const mech9_simulation *simulation, double *q, double *dq, double *ddq, mech9_error *error);
/* Motion of a named point in the system of link 1 [m, m/s, m/s2]. */
int mech9_simulation_point(const mech9_simulation *simulation, const char *name, double *position, double *velocity,
                           double *acceleration, mech9_error *error);
int mech9_simulation_energies(mech9_simulation *simulation, double *kinetic, double *potential, mech9_error *error);
double mech9_simulation_closure(const mech9_simulation *simulation);
/* A number of a load or a motor, from the present time on: "load(1).force(2)". */
int mech9_simulation_set(mech9_simulation *simulation, const char *name, double value, mech9_error *error);
/* Equations of motion of the n free coordinates in SI units: mass_matrix[n][n] ddq[n] + bias[n] = 0; null leaves one out. */
int mech9_simulation_free(const mech9_simulation *simulation);   /* n */
int mech9_simulation_equations(const mech9_simulation *simulation, int *numbers, double *mass_matrix, double *bias,
                               mech9_error *error);
/* The state as numbers in SI units: time, coordinates, rates, states of motors. */
int mech9_simulation_state_size(const mech9_simulation *simulation);
int mech9_simulation_state(const mech9_simulation *simulation, double *state, mech9_error *error);
int mech9_simulation_set_state(mech9_simulation *simulation, int n, const double *state, mech9_error *error);
/* The same for n motions of one mechanism. codes[n] has the exit code of each: a motion whose code is not 0 is left out, and
 * one that cannot go on gets its code. Rows of coordinates [n][M] that are not known are not numbers. */
int mech9_simulations_advance(mech9_simulation *const *simulations, int n, double t, int *codes, mech9_error *error);
int mech9_simulations_set(mech9_simulation *const *simulations, int n, const char *name, const double *values, const int *codes,
                          mech9_error *error);
int mech9_simulations_take(mech9_simulation *const *simulations, int n, const int *codes, double *q, double *dq, double *ddq,
                           mech9_error *error);

#ifdef __cplusplus
}
#endif
#endif
