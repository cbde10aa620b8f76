!> mech9d-mpi: studies of the dynamics of mechanisms, in several processes.
program mech9d_mpi
  use mech9_mpi_program, only: run_mpi_program
  use mech9_program_kind, only: dynamics
  implicit none

  call run_mpi_program(dynamics)
end program mech9d_mpi
