!> mech9d: dynamics of mechanisms from structural data.
program mech9d
  use mech9_program, only: run_program
  use mech9_dynamic_task, only: dynamic_task
  implicit none

  call run_program(dynamic_task())
end program mech9d
