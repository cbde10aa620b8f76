!> The starts of a search of a program: each is in the file as soon as it is made, and the terminal shows how many are made.
module mech9_starts
  use mech9_program_kind, only: program_names
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_progress, only: progress_type
  use mech9_synthesis, only: synthesis_type
  use mech9_search_starts, only: search_starts_type
  use mech9_signal_interruption, only: signal_interruption_type
  use mech9_starts_file, only: starts_file_type
  implicit none
  private
  public :: starts_type

  type, extends(search_starts_type) :: starts_type
    type(starts_file_type) :: file                   !< gets each start that is made
    type(progress_type), private :: progress
  contains
    procedure :: begin_shown
    procedure :: keep
    procedure :: tell_progress
    procedure :: finish
  end type starts_type

contains

  !> Begin to make the starts that are missing.
  subroutine begin_shown(self, program, quiet)
    class(starts_type), intent(inout) :: self        !< with room for all starts, and with those that were made before
    integer, intent(in) :: program                   !< kinematics or dynamics
    logical, intent(in) :: quiet                     !< no progress is shown

    call self%progress%start(program_names(program), quiet)
    call self%begin(signal_interruption_type())
  end subroutine begin_shown

  !> Write a start that is made.
  subroutine keep(self, number, err)
    class(starts_type), intent(inout) :: self               !< the starts
    integer, intent(in) :: number                           !< of the start, from 1
    type(error_type), allocatable, intent(out) :: err       !< allocated if the file cannot be written

    call self%file%write_start(number, self%made(number)%found)
    call self%file%tell(err)
  end subroutine keep

  !> Show how far the search is.
  subroutine tell_progress(self, share)
    class(starts_type), intent(inout) :: self        !< the starts
    real(wp), intent(in) :: share                    !< of the starts that are made, from 0 to 1

    if (share > 0.0_wp) call self%progress%update(share)
  end subroutine tell_progress

  !> End the progress, and add all starts that are made to a synthesis.
  subroutine finish(self, synthesis)
    class(starts_type), intent(inout) :: self        !< the starts
    type(synthesis_type), intent(inout) :: synthesis !< gets the designs

    call self%progress%finish()
    call self%search_starts_type%finish(synthesis)
  end subroutine finish
end module mech9_starts
