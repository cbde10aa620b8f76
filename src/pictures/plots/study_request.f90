!> The request for plots of a study: the argument of --plot, read against the parameters and quantities.
!>
!>     [TARGET:]NAME,NAME:NAME,NAME:NAME:NAME,...
!>
!> A single name is drawn as its histogram. Of a pair the second is drawn over the first, with its mean and its scatter.
!> Of three names the third is the colour of a map over the first two. Without names the histograms of the quantities
!> are drawn.
module mech9_study_request
  use mech9_error, only: error_type, raise, exit_usage
  use mech9_text, only: string_type
  use mech9_plot_request, only: plot_request_type, take_target, take_name
  implicit none
  private
  public :: study_request_type, panel_type, read_study_request

  integer, parameter :: most_names = 3    !< in one panel
  integer, parameter :: most_panels = 12  !< in one picture

  !> One panel: the numbers of its columns, among the parameters and the quantities behind them.
  type :: panel_type
    integer :: n = 1                     !< 1: histogram; 2: the second over the first; 3: map of the third over the first two
    integer :: columns(most_names) = 0
  end type panel_type

  type :: study_request_type
    character(len=:), allocatable :: target     !< file of the picture; empty: to be chosen
    logical :: in_terminal = .false.
    type(panel_type), allocatable :: panels(:)
  end type study_request_type

contains

  !> Read a request. An unknown name is an error of the command line (exit_usage).
  pure subroutine read_study_request(text, names, n_parameters, request, err)
    character(len=*), intent(in) :: text               !< the argument of --plot
    type(string_type), intent(in) :: names(:)          !< names of the parameters, and of the quantities behind them
    integer, intent(in) :: n_parameters                !< how many of them are parameters
    type(study_request_type), intent(out) :: request   !< request for the plots
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed
    type(plot_request_type) :: place
    type(panel_type) :: panel
    integer :: at, i

    call take_target(text, place, at)
    request%target = place%target
    request%in_terminal = place%in_terminal
    allocate (request%panels(0))
    if (at > len(text)) &
      request%panels = [(panel_type(1, [i, 0, 0]), i=n_parameters + 1, min(size(names), n_parameters + most_panels))]
    do while (at <= len(text))
      call take_panel(text, names, at, panel, err)
      if (allocated(err)) return
      request%panels = [request%panels, panel]
      if (at > len(text)) exit
      if (text(at:at) /= ',') then
        call raise(err, exit_usage, "--plot: a comma is missing before '"//text(at:)//"'")
        return
      end if
      at = at + 1
      if (at > len(text)) call take_panel(text, names, at, panel, err)
      if (allocated(err)) return
    end do
    call judge_request(request, err)
  end subroutine read_study_request

  !> Read a panel, written as up to three names with colons between them, and move `at` behind it.
  pure subroutine take_panel(text, names, at, panel, err)
    character(len=*), intent(in) :: text               !< the argument of --plot
    type(string_type), intent(in) :: names(:)          !< names of the columns
    integer, intent(inout) :: at                       !< place in `text` where the panel begins; afterwards the place behind it
    type(panel_type), intent(out) :: panel             !< its columns
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed
    integer :: n

    do n = 1, most_names
      panel%n = n
      call take_name(text, names, at, panel%columns(n), err)
      if (allocated(err)) return
      if (text(at:min(at, len(text))) /= ':') return
      if (n < most_names) at = at + 1
    end do
    call raise(err, exit_usage, '--plot: a plot of a study takes one name (a histogram), two (the second over the first) or '// &
               "three (a map of the third over the first two), and here are more: '"//text(at:)//"'")
  end subroutine take_panel

  !> Fail where a picture cannot be drawn.
  pure subroutine judge_request(request, err)
    type(study_request_type), intent(in) :: request    !< the whole request
    type(error_type), allocatable, intent(out) :: err  !< allocated if it cannot

    if (size(request%panels) == 0) then
      call raise(err, exit_usage, '--plot: this study has no quantities; name a parameter, or add a &quantity')
    else if (size(request%panels) > most_panels) then
      call raise(err, exit_usage, '--plot: a picture of a study has at most 12 plots; give --plot again for others')
    else if (request%in_terminal .and. any(request%panels%n == most_names)) then
      call raise(err, exit_usage, '--plot: a terminal cannot show a map; name a picture, as in --plot map.svg:a:b:c')
    end if
  end subroutine judge_request
end module mech9_study_request
