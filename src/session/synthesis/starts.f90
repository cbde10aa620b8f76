!> The starts of a synthesis: choosing the next one to be made, and keeping those that are made.
!>
!> A maker of starts asks for a number (`hand_out`) and gives the designs back when the start is made (`take`). Several
!> may do so at a time, as long as the calls come one after the other. A start is in the file as soon as it is taken.
module mech9_starts
  use mech9_program_kind, only: program_names
  use mech9_kinds, only: wp
  use mech9_text, only: to_text
  use mech9_counted, only: counted
  use mech9_error, only: error_type, raise, exit_interrupted
  use mech9_system, only: interrupted
  use mech9_progress, only: progress_type
  use mech9_design_search, only: found_design_type
  use mech9_synthesis, only: synthesis_type
  use mech9_starts_file, only: starts_file_type, start_type
  implicit none
  private
  public :: starts_type, all_handed_out

  !> Answer in place of the number of a start: there are no more.
  integer, parameter :: all_handed_out = 0

  type :: starts_type
    type(start_type), allocatable :: made(:)         !< all starts; those that were made before have their designs from the beginning
    type(starts_file_type) :: file                   !< gets each start that is made
    type(error_type), allocatable :: stopped         !< allocated where the file cannot be written, or the user interrupts
    type(progress_type), private :: progress
    integer, private :: handed_out = 0               !< starts that were handed out or skipped, the first ones
    integer, private :: missing = 0                  !< how many were to be made at the beginning
    integer, private :: taken = 0                    !< how many of these are made
  contains
    procedure :: begin
    procedure :: hand_out
    procedure :: take
    procedure :: finish
  end type starts_type

contains

  !> Begin to make the starts that are missing.
  subroutine begin(self, program, quiet)
    class(starts_type), intent(inout) :: self        !< with room for all starts, and with those that were made before
    integer, intent(in) :: program                   !< kinematics or dynamics
    logical, intent(in) :: quiet                     !< no progress is shown
    integer :: i

    self%missing = count([(.not. allocated(self%made(i)%found), i=1, size(self%made))])
    call self%progress%start(program_names(program), quiet)
  end subroutine begin

  !> The number of a start to be made next, or all_handed_out. Starts that were made before are not handed out.
  integer function hand_out(self) result(number)
    class(starts_type), intent(inout) :: self        !< the starts

    number = all_handed_out
    if (allocated(self%stopped)) return
    if (interrupted()) return
    do while (self%handed_out < size(self%made))
      self%handed_out = self%handed_out + 1
      if (allocated(self%made(self%handed_out)%found)) cycle
      number = self%handed_out
      return
    end do
  end function hand_out

  !> Take the designs to which a start led.
  subroutine take(self, number, found)
    class(starts_type), intent(inout) :: self                            !< the starts
    integer, intent(in) :: number                                        !< of the start, from 1
    type(found_design_type), allocatable, intent(inout) :: found(:)      !< the designs; not allocated on return
    type(error_type), allocatable :: err

    call move_alloc(found, self%made(number)%found)
    self%taken = self%taken + 1
    call self%file%write_start(number, self%made(number)%found)
    call self%file%tell(err)
    if (allocated(err) .and. .not. allocated(self%stopped)) call move_alloc(err, self%stopped)
    call self%progress%update(real(self%taken, wp)/self%missing)
  end subroutine take

  !> Add all starts that are made to a synthesis, in the order of their numbers, and end the progress. Where starts are missing and
  !> the file is sound, the user interrupted.
  subroutine finish(self, synthesis)
    class(starts_type), intent(inout) :: self        !< the starts
    type(synthesis_type), intent(inout) :: synthesis !< gets the designs
    integer :: i

    call self%progress%finish()
    do i = 1, size(self%made)
      if (allocated(self%made(i)%found)) call synthesis%add(i, self%made(i)%found)
    end do
    if (synthesis%done < size(self%made) .and. .not. allocated(self%stopped)) &
      call raise(self%stopped, exit_interrupted, 'interrupted: '//to_text(synthesis%done)//' of '// &
                 counted(size(self%made), 'start')//' are made')
  end subroutine finish
end module mech9_starts
