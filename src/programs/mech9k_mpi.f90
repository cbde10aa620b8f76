!> mech9k-mpi: studies of the kinematics of mechanisms, in several processes.
program mech9k_mpi
  use mech9_mpi_program, only: run_mpi_program
  use mech9_program_kind, only: kinematics
  implicit none

  call run_mpi_program(kinematics)
end program mech9k_mpi
