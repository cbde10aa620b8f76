!> mech9d: dynamics of mechanisms from structural data.
program mech9d
  use mech9_program, only: run_program
  use mech9_program_kind, only: dynamics
  implicit none

  call run_program(dynamics)
end program mech9d
