!> Equilibria and modes of vibration as the library's users find them: tables of numbers with named columns.
module mech9_recorded_rest
  use mech9_program_kind, only: dynamics
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_text, only: string_type, texts_of_one_length
  use mech9_model, only: model_type
  use mech9_simulation, only: interruption_type
  use mech9_columns, only: columns_type
  use mech9_rest, only: rest_type, is_interruption
  use mech9_equilibrium_rows, only: columns_of_equilibria, rows_of_equilibria, columns_of_modes, rows_of_modes
  use mech9_film, only: film_type
  use mech9_force_record, only: force_record_type
  use mech9_data_file, only: data_file_type
  use mech9_checked_mechanism, only: checked_mechanism_type
  implicit none
  private
  public :: recorded_rest_type, rest_of_file_type

  !> Columns have the names, units and order of the tables of mech9d.
  type :: recorded_rest_type
    character(len=:), allocatable :: names(:)    !< (columns)
    character(len=:), allocatable :: units(:)    !< (columns)
    real(wp), allocatable :: rows(:, :)          !< (columns,rows) a row for each equilibrium or mode
  contains
    procedure :: find_equilibria
    procedure :: find_modes
  end type recorded_rest_type

  !> The equilibria of a data file, with the numbers that a program writes of them.
  type, extends(rest_type) :: rest_of_file_type
    type(columns_type) :: columns                !< of the rows
    real(wp), allocatable :: rows(:, :)          !< (columns,rows) a row for each equilibrium or mode
    type(force_record_type) :: forces            !< with the components that are unique, once these are judged
    type(film_type) :: film                      !< of one mode
  contains
    procedure :: list_rows
    procedure :: judge_forces
    procedure :: take_film
    procedure, nopass :: stops_by => is_interruption
  end type rest_of_file_type

contains

  !> List the equilibria, or the modes of the first one, as rows. Fails where forces cannot be found.
  subroutine list_rows(self, given, of_modes, err)
    class(rest_of_file_type), intent(inout) :: self        !< with its equilibria; gets columns and rows
    class(data_file_type), intent(in) :: given             !< the data file
    logical, intent(in) :: of_modes                        !< rows are those of modes
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed

    if (of_modes) then
      self%columns = columns_of_modes(given%model%mechanism)
      call rows_of_modes(self%equilibria(1), self%rows)
    else
      self%columns = columns_of_equilibria(given%model)
      call rows_of_equilibria(given%model, self%columns, self%equilibria, self%rows, err)
    end if
  end subroutine list_rows

  !> Take the positions of one period of a mode of the first equilibrium.
  subroutine take_film(self, given, mode, err)
    class(rest_of_file_type), intent(inout) :: self        !< with its modes; gets the positions
    class(data_file_type), intent(in) :: given             !< the data file
    integer, intent(in) :: mode                            !< number of the mode
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed
    type(film_type) :: film

    call self%film_mode(given%model, mode, film, err)
    self%film = film
  end subroutine take_film

  !> Find which components of the forces in pairs are unique in the first equilibrium, if any are recorded.
  subroutine judge_forces(self, given)
    class(rest_of_file_type), intent(inout) :: self        !< with its equilibria; gets the components
    class(data_file_type), intent(in) :: given             !< the data file

    associate (resting => self%equilibria(1)%resting)
      call self%forces%judge(given%model, resting%plan, resting%state)
    end associate
  end subroutine judge_forces

  !> Find the equilibrium to which the start leads, or those of many random starts. Fails with exit_data where nothing can come to
  !> rest, with exit_assembly where there is no equilibrium, and with exit_interrupted where it is stopped; the equilibria that were
  !> found before are then there.
  subroutine find_equilibria(self, mechanism, starts, err, interruption)
    class(recorded_rest_type), intent(inout) :: self                 !< gets the equilibria
    type(checked_mechanism_type), intent(in) :: mechanism            !< with free coordinates, bodies and loads
    integer, intent(in) :: starts                                    !< number of random starts; 0: the start of the mechanism alone
    type(error_type), allocatable, intent(out) :: err                !< allocated if it failed
    class(interruption_type), intent(in), optional :: interruption   !< is asked before each start whether the search shall stop
    type(model_type) :: model
    type(rest_type) :: rest
    type(error_type), allocatable :: stopped

    call find_rest(self, mechanism, starts, .false., model, rest, err, interruption)
    if (is_interruption(err) .and. size(rest%equilibria) > 0) call move_alloc(err, stopped)
    if (.not. allocated(err)) then
      call name_columns(self, columns_of_equilibria(model))
      call rows_of_equilibria(model, columns_of_equilibria(model), rest%equilibria, self%rows, err)
    end if
    if (.not. allocated(err) .and. allocated(stopped)) call move_alloc(stopped, err)
    call mechanism%point_at(err)
  end subroutine find_equilibria

  !> Find the modes of vibration about the equilibrium to which the start leads. Fails as find_equilibria does, and with exit_data
  !> where a free coordinate moves no mass.
  subroutine find_modes(self, mechanism, err)
    class(recorded_rest_type), intent(inout) :: self                 !< gets the modes
    type(checked_mechanism_type), intent(in) :: mechanism            !< with free coordinates, bodies and loads
    type(error_type), allocatable, intent(out) :: err                !< allocated if it failed
    type(model_type) :: model
    type(rest_type) :: rest

    call find_rest(self, mechanism, 0, .true., model, rest, err)
    if (.not. allocated(err)) then
      call name_columns(self, columns_of_modes(model%mechanism))
      call rows_of_modes(rest%equilibria(1), self%rows)
    end if
    call mechanism%point_at(err)
  end subroutine find_modes

  !> Find the equilibria, without their rows.
  subroutine find_rest(self, mechanism, starts, with_modes, model, rest, err, interruption)
    class(recorded_rest_type), intent(inout) :: self                 !< loses its rows
    type(checked_mechanism_type), intent(in) :: mechanism            !< the mechanism
    integer, intent(in) :: starts                                    !< number of random starts; 0: the start of the mechanism alone
    logical, intent(in) :: with_modes                                !< modes are needed
    type(model_type), intent(out) :: model                           !< of the mechanism
    type(rest_type), intent(out) :: rest                             !< the equilibria
    type(error_type), allocatable, intent(out) :: err                !< allocated if it failed
    class(interruption_type), intent(in), optional :: interruption   !< is asked before each start
    type(string_type) :: none(0)

    call texts_of_one_length(none, self%names)
    call texts_of_one_length(none, self%units)
    self%rows = reshape([real(wp) ::], [0, 0])
    allocate (rest%equilibria(0))
    call mechanism%take_request(dynamics, model, err)
    if (.not. allocated(err)) call rest%assemble(model, err)
    if (.not. allocated(err)) call rest%find(model, starts, with_modes, err, interruption)
  end subroutine find_rest

  !> Take the names and units of columns.
  subroutine name_columns(self, columns)
    class(recorded_rest_type), intent(inout) :: self   !< gets them
    type(columns_type), intent(in) :: columns          !< the columns

    call texts_of_one_length(columns%names(:columns%count), self%names)
    call texts_of_one_length(columns%units(:columns%count), self%units)
  end subroutine name_columns
end module mech9_recorded_rest
