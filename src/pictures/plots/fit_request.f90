!> The request for a plot of targets and the design that meets them best: the argument of --plot, read against the objectives.
!>
!>     [TARGET:]NAME,NAME,...
!>
!> A name is that of an objective: its point, coordinate or link. Without names all objectives are drawn.
module mech9_fit_request
  use mech9_error, only: error_type, raise, exit_usage
  use mech9_text, only: string_type
  use mech9_plot_request, only: plot_request_type, take_target
  implicit none
  private
  public :: fit_request_type, read_fit_request

  type :: fit_request_type
    character(len=:), allocatable :: target     !< file of the picture; empty: to be chosen
    logical :: in_terminal = .false.
    logical, allocatable :: wanted(:)           !< (objectives) the objective is drawn
  end type fit_request_type

contains

  !> Read a request. An unknown name is an error of the command line (exit_usage).
  pure subroutine read_fit_request(text, names, request, err)
    character(len=*), intent(in) :: text               !< the argument of --plot
    type(string_type), intent(in) :: names(:)          !< of the objectives that have targets; others are empty
    type(fit_request_type), intent(out) :: request     !< request for the plot
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed
    type(plot_request_type) :: place
    integer :: at, comma, i

    call take_target(text, place, at)
    request%target = place%target
    request%in_terminal = place%in_terminal
    request%wanted = [(at > len(text) .and. names(i)%text /= '', i=1, size(names))]
    do while (at <= len(text))
      comma = at - 1 + index(text(at:)//',', ',')
      call want(trim(adjustl(text(at:comma - 1))), names, request%wanted, err)
      if (allocated(err)) return
      at = comma + 1
    end do
    if (.not. any(request%wanted)) &
      call raise(err, exit_usage, '--plot: beside --optimize it shows targets, and no &objective of this file has any')
  end subroutine read_fit_request

  !> Mark the objectives of a name as wanted.
  pure subroutine want(name, names, wanted, err)
    character(len=*), intent(in) :: name               !< without blanks around it
    type(string_type), intent(in) :: names(:)          !< of the objectives; empty for those that have no targets
    logical, intent(inout) :: wanted(:)                !< (objectives) the objective is drawn
    type(error_type), allocatable, intent(out) :: err  !< allocated if there are none
    character(len=:), allocatable :: list
    logical :: found
    integer :: i

    found = .false.
    list = ''
    do i = 1, size(names)
      if (names(i)%text == '') cycle
      list = list//' '//names(i)%text
      if (names(i)%text /= name) cycle
      wanted(i) = .true.
      found = .true.
    end do
    if (found .or. list == '') return
    call raise(err, exit_usage, "--plot: beside --optimize it shows the targets of an &objective, and none is about '"//name// &
               "'; there are"//list)
  end subroutine want
end module mech9_fit_request
