!> mech9k: kinematics of mechanisms from structural data.
program mech9k
  use mech9_program, only: run_program
  use mech9_kinematic_task, only: kinematic_task
  implicit none

  call run_program(kinematic_task())
end program mech9k
