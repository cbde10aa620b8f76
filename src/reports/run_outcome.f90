!> The rows and the times of a run, for its report.
module mech9_run_outcome
  use mech9_kinds, only: wp
  implicit none
  private
  public :: run_outcome_type

  type :: run_outcome_type
    integer :: rows = 0                      !< how many rows were computed
    real(wp) :: seconds_solving = 0.0_wp     !< real time [s]
    real(wp) :: seconds_writing = 0.0_wp     !< real time [s]
  end type run_outcome_type
end module mech9_run_outcome
