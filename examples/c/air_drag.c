/* A falling weight in air: its drag, and the motion under forces that follows from it. */
#include <math.h>
#include <mech9.h>
#include <stdio.h>

/* A force k |v| v against the velocity of the weight, which is link 2. k is in the group &user. */
static int drag(double t, const mech9_motion *motion, int n, const double *parameters, mech9_loads *loads, void *data)
{
  const double centre[3] = {0, 0, 0};
  double v[3], force[3];

  (void)t, (void)data;
  if (n < 1) return 1;
  mech9_motion_velocity(motion, 2, centre, v);
  double speed = sqrt(v[0]*v[0] + v[1]*v[1] + v[2]*v[2]);
  for (int i = 0; i < 3; i++) force[i] = -parameters[0]*speed*v[i];
  mech9_loads_add_force(loads, motion, 2, centre, force);
  return 0;
}

int main(void)
{
  const char *groups = "&structure cq=1 / &pair coordinate=1, links=1,2, kind='prismatic', axis=0,0,-1 / &body link=2, mass=2 / "
                       "&gravity acceleration=0,0,-9.81 / &load kind='user' / &user parameters=0.1 / "
                       "&initial coordinate=1, position=0, velocity=0 / &time end=5, intervals=5 /";
  mech9_error *error = mech9_error_create();
  mech9_mechanism *mechanism = NULL;
  mech9_results *run = NULL;

  if (!mech9_read_text(groups, &mechanism, error) && !mech9_mechanism_use_force(mechanism, drag, NULL, error) &&
      !mech9_dynamics(mechanism, NULL, &run, error))
    for (int i = 0; i < mech9_results_rows(run); i++) {
      const double *row = mech9_results_data(run) + i*mech9_results_columns(run);
      printf("t = %.0f s: %.6f m, %.6f m/s\n", row[0], row[1], row[2]);
    }
  int code = mech9_error_code(error);
  if (code) fprintf(stderr, "%s\n", mech9_error_message(error));
  mech9_results_destroy(run);
  mech9_mechanism_destroy(mechanism);
  mech9_error_destroy(error);
  return code;
}
