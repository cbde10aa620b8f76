!> Equilibria and modes as columns and rows of tables.
module mech9_equilibrium_rows
  use mech9_kinds, only: wp, pi
  use mech9_text, only: to_text
  use mech9_error, only: error_type
  use mech9_mechanism, only: mechanism_type
  use mech9_model, only: model_type
  use mech9_state, only: state_type
  use mech9_reactions, only: reactions_type
  use mech9_single_reactions, only: find_single_reactions
  use mech9_result_units, only: si_unit, unit_name
  use mech9_columns, only: columns_type
  use mech9_contact_columns, only: append_contacts, fill_contacts
  use mech9_force_record, only: force_record_type, fill_wrenches
  use mech9_linearised_equilibrium, only: equilibrium_type
  use mech9_mode_shapes, only: shape_of_mode
  implicit none
  private
  public :: columns_of_equilibria, rows_of_equilibria, columns_of_modes, rows_of_modes

contains

  !> The columns of a table of equilibria, with the forces that the data file asks for.
  function columns_of_equilibria(model) result(columns)
    type(model_type), intent(in) :: model   !< the model
    type(columns_type) :: columns
    class(force_record_type), allocatable :: forces
    integer :: k

    allocate (forces, columns%names(0), columns%units(0), columns%long_names(0))
    columns%system = model%mechanism%units
    call columns%append('equilibrium', '', 'number of the position of equilibrium')
    do k = 1, size(model%mechanism%pairs)
      call columns%append_in('q'//to_text(k), si_unit(model%mechanism%pairs(k)%pair))
    end do
    columns%motion = columns%count
    call forces%begin(model, columns)
    call columns%append_motors(model%mechanism)
    call forces%append_magnitudes(model, columns)
    call columns%append_stops(model%mechanism)
    call append_contacts(columns, model%mechanism)
    call columns%append('stable', '', '1 where no small deviation grows, else 0')
    call columns%append('growth', '1/s', 'largest real part of the eigenvalues of the linearised equations of motion')
  end function columns_of_equilibria

  !> Form the rows of a table of equilibria. Fail where forces are requested and a load fails, or they are infinite.
  subroutine rows_of_equilibria(model, columns, list, rows, err)
    type(model_type), intent(in) :: model                   !< the model
    type(columns_type), intent(in) :: columns               !< of the table
    type(equilibrium_type), intent(in) :: list(:)           !< the equilibria
    real(wp), allocatable, intent(out) :: rows(:, :)        !< (columns, rows)
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    integer :: i, k, m

    m = size(model%mechanism%pairs)
    allocate (rows(columns%count, size(list)))
    do i = 1, size(list)
      rows(1, i) = i
      do k = 1, m
        rows(1 + k, i) = list(i)%resting%state%q(k)
      end do
      if (columns%forces() > 0) call fill_forces(model, columns, list(i), rows(:, i), err)
      if (.not. allocated(err)) &
        call columns%fill_motors(model%mechanism, list(i)%resting%plan, list(i)%resting%state, rows(:, i), err)
      if (allocated(err)) return
      call columns%fill_stops(model%mechanism, list(i)%resting%state, rows(:, i))
      call fill_contacts(columns, model%mechanism, list(i)%resting%plan, list(i)%resting%state, rows(:, i))
      rows(columns%count - 1, i) = merge(1.0_wp, 0.0_wp, list(i)%is_stable)
      rows(columns%count, i) = list(i)%modes%growth
      call columns%convert(rows(:, i))
    end do
  end subroutine rows_of_equilibria

  !> Fill the columns of forces: those of drives, and those in pairs.
  subroutine fill_forces(model, columns, equilibrium, row, err)
    type(model_type), intent(in) :: model                   !< the model
    type(columns_type), intent(in) :: columns               !< of the table
    type(equilibrium_type), intent(in) :: equilibrium       !< the equilibrium
    real(wp), intent(inout) :: row(:)                       !< gets the forces
    type(error_type), allocatable, intent(out) :: err       !< allocated if a load failed, or forces are infinite
    class(reactions_type), allocatable :: reactions
    type(state_type) :: state

    state = equilibrium%resting%state
    call find_single_reactions(model%mechanism, equilibrium%resting%plan, state, reactions, err)
    if (.not. allocated(err)) &
      call fill_wrenches(reactions, columns, model%mechanism, equilibrium%resting%plan, state, row)
  end subroutine fill_forces

  !> The columns of a table of modes.
  function columns_of_modes(mechanism) result(columns)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(columns_type) :: columns
    integer :: k

    allocate (columns%names(0), columns%units(0), columns%long_names(0))
    call columns%append('mode', '', 'number of the mode')
    call columns%append('eigenvalue.re', '1/s', 'real part of the eigenvalue: growth')
    call columns%append('eigenvalue.im', '1/s', 'imaginary part of the eigenvalue: angular frequency')
    call columns%append('frequency', 'Hz', 'frequency of the vibration')
    call columns%append('damping', '', 'damping as a part of the critical one')
    do k = 1, size(mechanism%pairs)
      call columns%append('q'//to_text(k)//'.re', trim(unit_name(mechanism, k)), 'amplitude in phase')
      call columns%append('q'//to_text(k)//'.im', trim(unit_name(mechanism, k)), 'amplitude a quarter of a period before')
    end do
  end function columns_of_modes

  !> Form the rows of a table of modes.
  subroutine rows_of_modes(equilibrium, rows)
    type(equilibrium_type), intent(inout) :: equilibrium   !< with its modes
    real(wp), allocatable, intent(out) :: rows(:, :)       !< (columns, rows)
    complex(wp) :: shape(equilibrium%resting%plan%n_coordinates), root
    integer :: i

    allocate (rows(5 + 2*size(shape), equilibrium%modes%count))
    do i = 1, equilibrium%modes%count
      root = equilibrium%modes%roots(i)
      rows(1, i) = i
      rows(2, i) = real(root, wp)
      rows(3, i) = aimag(root)
      rows(4, i) = abs(aimag(root))/(2.0_wp*pi)
      rows(5, i) = 0.0_wp
      if (abs(root) > 0.0_wp) rows(5, i) = -real(root, wp)/abs(root)
      call shape_of_mode(equilibrium, i, shape)
      rows(6::2, i) = real(shape, wp)
      rows(7::2, i) = aimag(shape)
    end do
    ! no negative zeros in tables
    rows = rows + 0.0_wp
  end subroutine rows_of_modes
end module mech9_equilibrium_rows
