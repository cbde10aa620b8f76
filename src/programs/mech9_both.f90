!> mech9k and mech9d in one file, which holds once what both need: it is mech9d where it is called by a name that ends so.
program mech9_both
  use mech9_program, only: run_program
  use mech9_system, only: take_argument
  use mech9_program_kind, only: kinematics, dynamics
  implicit none
  character(len=:), allocatable :: name

  call take_argument(0, name)
  if (name(max(1, len(name) - 5):) == 'mech9d') then
    call run_program(dynamics)
  else
    call run_program(kinematics)
  end if
end program mech9_both
