!> The interface of what takes the runs of a study: files of a program, or arrays in memory.
module mech9_study_sink
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_run_maker, only: made_run_type
  use mech9_section_record, only: section_record_type
  use mech9_study_sums, only: study_sums_type
  implicit none
  private
  public :: study_sink_type

  type, abstract :: study_sink_type
    integer :: part(2) = 1   !< number of the part of the study that is made, and how many parts there are
    class(section_record_type), allocatable :: section   !< points of all runs; not allocated: there is none
  contains
    procedure(is_made_interface), deferred :: is_made
    procedure(read_interface), deferred :: read_run
    procedure(write_interface), deferred :: write_run
    procedure(show_interface), deferred :: show_run
    procedure(progress_interface), deferred :: tell_progress
    procedure(close_interface), deferred :: close
  end type study_sink_type

  abstract interface
    !> Whether a run was made before, so that it can be read.
    logical function is_made_interface(self, place)
      import :: study_sink_type
      class(study_sink_type), intent(inout) :: self          !< takes the runs
      integer, intent(in) :: place                           !< of the run in the part, from 1
    end function is_made_interface

    !> Read a run that was made before.
    subroutine read_interface(self, place, run)
      import :: study_sink_type, made_run_type
      class(study_sink_type), intent(inout) :: self          !< takes the runs
      integer, intent(in) :: place                           !< of the run in the part, from 1
      type(made_run_type), intent(inout) :: run              !< gets its numbers; its arrays are allocated
    end subroutine read_interface

    !> Take a run as soon as it is made. Runs come in any order.
    subroutine write_interface(self, place, run, err)
      import :: study_sink_type, made_run_type, error_type
      class(study_sink_type), intent(inout) :: self          !< takes the runs
      integer, intent(in) :: place                           !< of the run in the part, from 1
      type(made_run_type), intent(in) :: run                 !< the run
      type(error_type), allocatable, intent(out) :: err      !< allocated if it failed
    end subroutine write_interface

    !> Take a run when its turn has come. Runs come in the order of their numbers, without their rows.
    subroutine show_interface(self, run, err)
      import :: study_sink_type, made_run_type, error_type
      class(study_sink_type), intent(inout) :: self          !< takes the runs
      type(made_run_type), intent(in) :: run                 !< the run
      type(error_type), allocatable, intent(out) :: err      !< allocated if it failed
    end subroutine show_interface

    !> Learn how far the study is.
    subroutine progress_interface(self, done, read, sums)
      import :: study_sink_type, study_sums_type, wp
      class(study_sink_type), intent(inout) :: self          !< takes the runs
      real(wp), intent(in) :: done                           !< share of the runs that are shown, up to 1
      real(wp), intent(in) :: read                           !< share of the runs that were made before
      type(study_sums_type), intent(in) :: sums              !< over the runs that are shown
    end subroutine progress_interface

    !> End after the last run, or after a stop.
    subroutine close_interface(self, err)
      import :: study_sink_type, error_type
      class(study_sink_type), intent(inout) :: self          !< takes the runs
      type(error_type), allocatable, intent(out) :: err      !< allocated if runs could not be kept
    end subroutine close_interface
  end interface
end module mech9_study_sink
