!> mech9k-mpi: studies of the kinematics of mechanisms, in several processes.
program mech9k_mpi
  use mech9_mpi_program, only: run_mpi_program
  use mech9_kinematic_task, only: kinematic_task
  implicit none

  call run_mpi_program(kinematic_task())
end program mech9k_mpi
