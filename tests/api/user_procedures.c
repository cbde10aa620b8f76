/* The samples of user_procs as functions of C. Arguments: the sample, its data file, and a word: exact for functions with derivatives,
 * values for functions without, failing for ones that have no values, wrong for a force on a link that does not exist. */
#include <math.h>
#include <mech9.h>
#include <stdio.h>
#include <string.h>

static const char *form;

static int trammel(int coordinate, double q, int n, const double *parameters, double points[3][3][3], void *data)
{
  if (coordinate != 1 || n != 1 || data != &form || !strcmp(form, "failing")) return 1;
  int derivatives = strcmp(form, "exact") ? 0 : 2;
  const double c[3] = {cos(q), -sin(q), -cos(q)}, s[3] = {sin(q), cos(q), -sin(q)};
  for (int d = 0; d <= derivatives; d++) {
    memset(points[d], 0, sizeof points[d]);
    points[d][0][0] = points[d][2][0] = parameters[0]*c[d];
    points[d][1][1] = parameters[0]*s[d];
  }
  points[0][2][2] = -1;
  return 0;
}

static int cycloid(int coordinate, double t, int n, const double *parameters, double values[3], void *data)
{
  if (coordinate != 4 || n != 2 || data != &form || !strcmp(form, "failing")) return 1;
  double turn = 8*atan(1), share = t/parameters[1];
  values[0] = parameters[0]*(share - sin(turn*share)/turn);
  if (strcmp(form, "exact")) return 0;
  values[1] = parameters[0]/parameters[1]*(1 - cos(turn*share));
  values[2] = parameters[0]/(parameters[1]*parameters[1])*turn*sin(turn*share);
  return 0;
}

static int cardan(int coupling, double first, int n, const double *parameters, double values[3], void *data)
{
  if (coupling != 1 || n != 1 || data != &form || !strcmp(form, "failing")) return 1;
  double k = cos(parameters[0]), s = sin(first), c = cos(first), d = s*s + k*k*c*c;
  values[0] = first + atan2((1 - k)*s*c, s*s + k*c*c);
  if (strcmp(form, "exact")) return 0;
  values[1] = k/d;
  values[2] = -2*k*(1 - k*k)*s*c/(d*d);
  return 0;
}

static int drag(double t, const mech9_motion *motion, int n, const double *parameters, mech9_loads *loads, void *data)
{
  if (t < 0 || data != &form || !strcmp(form, "failing")) return 1;
  for (int i = 0; i + 4 < n; i += 5) {
    int link = (int)parameters[i];
    double v[3], force[3];
    mech9_motion_velocity(motion, link, parameters + i + 1, v);
    double speed = sqrt(v[0]*v[0] + v[1]*v[1] + v[2]*v[2]);
    for (int j = 0; j < 3; j++) force[j] = -parameters[i + 4]*speed*v[j];
    mech9_loads_add_force(loads, motion, strcmp(form, "wrong") ? link : 40, parameters + i + 1, force);
  }
  return 0;
}

int main(int arguments, char **argument)
{
  mech9_error *error = mech9_error_create();
  mech9_mechanism *mechanism = NULL, *copy = NULL;
  mech9_results *run = NULL;
  int code = 1;

  if (arguments != 4) return 1;
  form = argument[3];
  if (!mech9_read_file(argument[2], &mechanism, error)) {
    if (!strcmp(argument[1], "trammel")) code = mech9_mechanism_use_pair(mechanism, trammel, &form, error);
    if (!strcmp(argument[1], "cycloidal_drive")) code = mech9_mechanism_use_drive(mechanism, cycloid, &form, error);
    if (!strcmp(argument[1], "cardan_coupling")) code = mech9_mechanism_use_coupling(mechanism, cardan, &form, error);
    if (!strcmp(argument[1], "air_drag")) code = mech9_mechanism_use_force(mechanism, drag, &form, error);
    if (!strcmp(form, "none")) code = mech9_mechanism_use_pair(mechanism, NULL, NULL, error);
    /* a copy has the functions, too */
    if (!code && !mech9_mechanism_copy(mechanism, &copy, error)) {
      if (strcmp(argument[1], "air_drag")) mech9_kinematics(copy, NULL, &run, error);
      else mech9_dynamics(copy, NULL, &run, error);
    }
  }
  for (int column = 0; run && column < mech9_results_columns(run); column++)
    printf(column ? " %s" : "%s", mech9_results_name(run, column));
  for (int i = 0; run && i < mech9_results_rows(run)*mech9_results_columns(run); i++)
    printf(i % mech9_results_columns(run) ? " %.17g" : "\n%.17g", mech9_results_data(run)[i]);
  code = mech9_error_code(error);
  if (code) fprintf(stderr, "%s\n", mech9_error_message(error));
  mech9_results_destroy(run);
  mech9_mechanism_destroy(copy);
  mech9_mechanism_destroy(mechanism);
  mech9_error_destroy(error);
  return code;
}
