!> mech9k: kinematics of mechanisms from structural data.
program mech9k
  use mech9_program, only: run_program
  use mech9_program_kind, only: kinematics
  implicit none

  call run_program(kinematics)
end program mech9k
