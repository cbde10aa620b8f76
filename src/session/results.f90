!> All that a run writes its rows to, opened in one place from the options and the data file.
!> Uses error, text, mechanism, the sinks of the output and pictures floors, command_line, version.
module mech9_results
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_text, only: string_type
  use mech9_mechanism, only: mechanism_type
  use mech9_columns, only: columns_type
  use mech9_result_sink, only: result_sink_type, sink_slot_type, append_sink
  use mech9_table, only: table_type
  use mech9_plot, only: plot_type, default_picture
  use mech9_command_line, only: command_line_type
  use mech9_version, only: version
  implicit none
  private
  public :: results_type, table_path_of

  !> The open results of one run.
  type :: results_type
    character(len=:), allocatable :: table_path     !< '-' is standard output; empty: no table
    type(sink_slot_type), allocatable :: sinks(:)
  contains
    procedure :: open => open_results
    procedure :: write_rows
    procedure :: flush => flush_results
    procedure :: close => close_results
    procedure :: print_words
    procedure, private :: open_table
    procedure, private :: open_plots
  end type results_type

contains

  !> Where the table goes: the command line comes before the data file; without either, standard output, unless
  !> what is asked for is a picture.
  pure function table_path_of(options, mechanism) result(path)
    type(command_line_type), intent(in) :: options
    type(mechanism_type), intent(in) :: mechanism
    character(len=:), allocatable :: path

    path = '-'
    if (options%has('plot')) path = ''
    if (mechanism%output%table /= '') path = mechanism%output%table
    if (options%has('table')) path = options%argument('table')
    if (options%has('no-write')) path = ''
  end function table_path_of

  !> Open everything that is asked for; after an error nothing is open.
  subroutine open_results(self, options, mechanism, program_name, columns, err)
    class(results_type), intent(out) :: self
    type(command_line_type), intent(in) :: options
    type(mechanism_type), intent(in) :: mechanism
    character(len=*), intent(in) :: program_name
    type(columns_type), intent(in) :: columns        !< of the rows to come
    type(error_type), allocatable, intent(out) :: err
    type(error_type), allocatable :: at_close
    type(sink_slot_type), allocatable :: plots(:)
    integer :: i

    allocate (self%sinks(0))
    self%table_path = table_path_of(options, mechanism)
    ! a wrong name in a plot is found before a file is touched
    call self%open_plots(options, mechanism, columns, plots, err)
    if (.not. allocated(err) .and. self%table_path /= '') call self%open_table(mechanism, program_name, columns, err)
    if (allocated(err)) then
      call self%close(at_close)
      return
    end if
    do i = 1, size(plots)
      call append_sink(self%sinks, plots(i)%sink)
    end do
  end subroutine open_results

  !> The plots that are asked for.
  subroutine open_plots(self, options, mechanism, columns, plots, err)
    class(results_type), intent(in) :: self
    type(command_line_type), intent(in) :: options
    type(mechanism_type), intent(in) :: mechanism
    type(columns_type), intent(in) :: columns
    type(sink_slot_type), allocatable, intent(out) :: plots(:)
    type(error_type), allocatable, intent(out) :: err
    type(string_type), allocatable :: requests(:)
    type(plot_type), allocatable :: plot
    class(result_sink_type), allocatable :: sink
    integer :: i

    allocate (plots(0))
    call options%arguments('plot', requests)
    do i = 1, size(requests)
      allocate (plot)
      call plot%open(requests(i)%text, mechanism%title, columns%names(:columns%count), &
                     columns%units(:columns%count), mechanism%time%intervals + 1, &
                     default_picture(self%table_path, options%file, i), self%table_path, err)
      if (allocated(err)) return
      call move_alloc(plot, sink)
      call append_sink(plots, sink)
    end do
  end subroutine open_plots

  subroutine open_table(self, mechanism, program_name, columns, err)
    class(results_type), intent(inout) :: self
    type(mechanism_type), intent(in) :: mechanism
    character(len=*), intent(in) :: program_name
    type(columns_type), intent(in) :: columns
    type(error_type), allocatable, intent(out) :: err
    type(table_type), allocatable :: table
    class(result_sink_type), allocatable :: sink

    allocate (table)
    call table%open(self%table_path, mechanism%title, program_name//' '//version, &
                    columns%names(:columns%count), columns%units(:columns%count), err)
    if (allocated(err)) return
    call move_alloc(table, sink)
    call append_sink(self%sinks, sink)
  end subroutine open_table

  !> Rows to everyone; the first error ends it.
  subroutine write_rows(self, rows, err)
    class(results_type), intent(inout) :: self
    real(wp), intent(in) :: rows(:, :)      !< (columns, rows)
    type(error_type), allocatable, intent(out) :: err
    integer :: i

    do i = 1, size(self%sinks)
      call self%sinks(i)%sink%write_rows(rows, err)
      if (allocated(err)) return
    end do
  end subroutine write_rows

  !> Let no row wait any longer, in none of them; the first error is told.
  subroutine flush_results(self, err)
    class(results_type), intent(inout) :: self
    type(error_type), allocatable, intent(out) :: err
    type(error_type), allocatable :: one
    integer :: i

    do i = 1, size(self%sinks)
      call self%sinks(i)%sink%flush(one)
      if (.not. allocated(err)) call move_alloc(one, err)
    end do
  end subroutine flush_results

  !> Close all of them, whatever happens; the first error is told.
  subroutine close_results(self, err)
    class(results_type), intent(inout) :: self
    type(error_type), allocatable, intent(out) :: err
    type(error_type), allocatable :: one
    integer :: i

    do i = 1, size(self%sinks)
      call self%sinks(i)%sink%close(one)
      if (.not. allocated(err)) call move_alloc(one, err)
    end do
  end subroutine close_results

  !> What the user is told about what was written, once all is closed.
  subroutine print_words(self, unit)
    class(results_type), intent(in) :: self
    integer, intent(in) :: unit
    character(len=:), allocatable :: words
    integer :: i

    do i = 1, size(self%sinks)
      words = self%sinks(i)%sink%words()
      if (words /= '') write (unit, '(a)') words
    end do
  end subroutine print_words
end module mech9_results
