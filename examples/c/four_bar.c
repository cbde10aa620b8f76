/* A driven run from a data file, and a motion that the program advances itself. */
#include <mech9.h>
#include <stdio.h>

int main(int arguments, char **argument)
{
  mech9_error *error = mech9_error_create();
  mech9_mechanism *mechanism = NULL;
  mech9_results *run = NULL;
  mech9_simulation *motion = NULL;
  double q[4];

  if (!mech9_read_file(arguments > 1 ? argument[1] : "four_bar.nml", &mechanism, error) &&
      !mech9_mechanism_set(mechanism, "pair(2).point(1)", 0.25, error) &&
      !mech9_kinematics(mechanism, NULL, &run, error)) {
    const double *row = mech9_results_data(run);
    for (int i = 0; i < mech9_results_rows(run); i++, row += mech9_results_columns(run))
      printf("%s = %.2f %s, %s = %.6f %s\n", mech9_results_name(run, 0), row[0], mech9_results_unit(run, 0),
             mech9_results_name(run, 2), row[2], mech9_results_unit(run, 2));
    if (!mech9_simulation_create(mechanism, 0, NULL, &motion, error) && !mech9_simulation_advance(motion, 0.25, error) &&
        !mech9_simulation_take(motion, q, NULL, NULL, error))
      printf("at %.2f s: q2 = %.6f\n", mech9_simulation_time(motion), q[1]);
  }
  int code = mech9_error_code(error);
  if (code) fprintf(stderr, "%s\n", mech9_error_message(error));
  mech9_simulation_destroy(motion);
  mech9_results_destroy(run);
  mech9_mechanism_destroy(mechanism);
  mech9_error_destroy(error);
  return code;
}
