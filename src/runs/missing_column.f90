!> Why a run has no column of a name, and the setting by which it would have one.
module mech9_missing_column
  use mech9_text, only: to_text, nearest_name
  use mech9_partition, only: driven_coordinate
  use mech9_turning_plane, only: turning_plane_type, find_turning_plane
  use mech9_model, only: model_type
  use mech9_columns, only: columns_type
  implicit none
  private
  public :: find_remedy

contains

  !> The end of a message about a column that is not recorded: the setting that records it, or the column that may be meant.
  subroutine find_remedy(name, model, columns, remedy)
    character(len=*), intent(in) :: name          !< heading of the column
    type(model_type), intent(in) :: model         !< the model
    type(columns_type), intent(in) :: columns     !< of the run
    character(len=:), allocatable, intent(out) :: remedy   !< the end of the message; '' where there is none

    call find_remedy_of_motion(name, model, remedy)
    if (remedy == '') call find_remedy_of_force(name, model, remedy)
    if (remedy == '') call find_remedy_of_pair(name, model, remedy)
    if (remedy == '') call find_remedy_of_coupling(name, model, columns, remedy)
    if (remedy == '') call find_remedy_of_link(name, model, remedy)
    if (remedy == '' .and. name == 'conditioning') remedy = set_in_output('conditioning=.true.')
    if (remedy == '' .and. any(name == [character(len=11) :: 'E.kinetic', 'E.potential', 'E.total'])) then
      remedy = '; mech9d alone records energies'
      if (.not. model%request%output%energies) remedy = set_in_output('energies=.true.')
    end if
    if (remedy == '') call find_nearest(name, columns, remedy)
  end subroutine find_remedy

  !> The words for a setting of &output.
  pure function set_in_output(setting) result(words)
    character(len=*), intent(in) :: setting   !< the setting, as it stands in a data file
    character(len=len(setting) + 17) :: words

    words = '; set '//setting//' in &output'
  end function set_in_output

  !> Number that follows letters at the beginning of a name: 12 of ddq12 after ddq. 0 where the name has another form.
  pure integer function number_after(letters, name) result(number)
    character(len=*), intent(in) :: letters   !< the beginning of the name
    character(len=*), intent(in) :: name      !< heading of a column
    integer :: status

    number = 0
    if (len(name) <= len(letters) .or. len(name) > len(letters) + 8) return
    if (name(:len(letters)) /= letters .or. verify(name(len(letters) + 1:), '0123456789') > 0) return
    read (name(len(letters) + 1:), *, iostat=status) number
    if (status /= 0) number = 0
  end function number_after

  !> For coordinates and points, and their derivatives.
  subroutine find_remedy_of_motion(name, model, remedy)
    character(len=*), intent(in) :: name      !< heading of the column
    type(model_type), intent(in) :: model     !< the model
    character(len=:), allocatable, intent(out) :: remedy   !< the end of the message; '' where there is none
    character(len=3), parameter :: orders(0:2) = ['q  ', 'dq ', 'ddq']
    character(len=1), parameter :: point_orders(2) = ['v', 'a']
    logical :: recorded(size(model%mechanism%pairs))
    integer :: order, i, k

    remedy = ''
    recorded = model%request%output%recorded(size(recorded))
    associate (derivatives => model%request%output%derivatives)
      do order = 0, 2
        k = number_after(trim(orders(order)), name)
        if (k < 1 .or. k > size(recorded)) cycle
        if (.not. recorded(k)) then
          remedy = '; coordinate '//to_text(k)//' is not among coordinates in &output'
        else if (order > derivatives) then
          remedy = set_in_output('derivatives='//to_text(order))
        end if
      end do
      do order = derivatives + 1, 2
        do i = 1, size(model%mechanism%points)
          k = len(name)
          if (k /= len(model%mechanism%points(i)%name) + 3) cycle
          if (name(:k - 1) == model%mechanism%points(i)%name//'.'//point_orders(order) .and. scan(name(k:), 'xyz') == 1) &
            remedy = set_in_output('derivatives='//to_text(order))
        end do
      end do
    end associate
  end subroutine find_remedy_of_motion

  !> For forces of drives.
  subroutine find_remedy_of_force(name, model, remedy)
    character(len=*), intent(in) :: name      !< heading of the column
    type(model_type), intent(in) :: model     !< the model
    character(len=:), allocatable, intent(out) :: remedy   !< the end of the message; '' where there is none
    integer :: k

    remedy = ''
    k = number_after('F', name)
    if (k < 1 .or. k > size(model%problem%partition%kind)) return
    if (model%problem%partition%kind(k) /= driven_coordinate) then
      remedy = '; coordinate '//to_text(k)//' has no drive'
    else
      remedy = set_in_output('drive_forces=.true.')
    end if
  end subroutine find_remedy_of_force

  !> For forces and moments in pairs.
  subroutine find_remedy_of_pair(name, model, remedy)
    character(len=*), intent(in) :: name      !< heading of the column
    type(model_type), intent(in) :: model     !< the model
    character(len=:), allocatable, intent(out) :: remedy   !< the end of the message; '' where there is none
    integer :: k, point, first

    remedy = ''
    point = index(name, '.')
    if (point == 0) return
    if (all(name(point + 1:) /= ['fx', 'fy', 'fz', 'mx', 'my', 'mz', 'f ', 'm '])) return
    k = number_after('R', name(:point - 1))
    if (k < 1 .or. k > size(model%mechanism%pairs)) return
    first = model%mechanism%structure%first_of_joint(k)
    if (first /= k) then
      remedy = '; the first coordinate of its joint stands for it: R'//to_text(first)//name(point:)
    else if (.not. model%request%output%reactions) then
      remedy = set_in_output('reactions=.true.')
    else if (len(name) == point + 1 .and. .not. model%request%output%reaction_magnitudes) then
      remedy = set_in_output('reaction_magnitudes=.true.')
    else
      remedy = '; pair '//to_text(k)//' is not among reaction_pairs in &output'
    end if
  end subroutine find_remedy_of_pair

  !> For the turning motion of links and for poles.
  subroutine find_remedy_of_link(name, model, remedy)
    character(len=*), intent(in) :: name      !< heading of the column
    type(model_type), intent(in) :: model     !< the model
    character(len=:), allocatable, intent(out) :: remedy   !< the end of the message; '' where there is none
    type(turning_plane_type) :: plane
    integer :: k, point
    logical :: is_plane, is_space

    remedy = ''
    point = index(name, '.')
    if (point == 0) return
    k = number_after('L', name(:point - 1))
    if (k < 1) return
    is_plane = any(name(point + 1:) == [character(len=6) :: 'phi', 'omega', 'alpha', 'pole.x', 'pole.y', 'pole.z'])
    is_space = any(name(point + 1:) == [character(len=6) :: 'e0', 'e1', 'e2', 'e3', 'wx', 'wy', 'wz', 'alphax', 'alphay', 'alphaz'])
    if (.not. (is_plane .or. is_space)) return
    call find_turning_plane(model%mechanism%structure, model%mechanism%pairs, plane)
    associate (output => model%request%output)
      if (k > model%mechanism%structure%shown_links()) then
        remedy = '; there is no link '//to_text(k)
      else if (k == 1) then
        remedy = '; link 1 is the frame, which does not move'
      else if (is_plane .and. .not. plane%found) then
        remedy = '; the mechanism is not planar: its links have L'//to_text(k)//'.e0 to e3, wx to wz, alphax to alphaz'
      else if (is_space .and. plane%found) then
        remedy = '; the mechanism is planar: its links have L'//to_text(k)//'.phi, omega and alpha'
      else if (index(name, '.pole.') > 0) then
        if (all(output%poles /= k)) remedy = set_in_output('poles='//to_text(k))
      else if (all(output%links /= k)) then
        remedy = set_in_output('links='//to_text(k))
      else
        remedy = set_in_output('derivatives='//trim(merge('2', '1', index(name, '.alpha') > 0)))
      end if
    end associate
  end subroutine find_remedy_of_link

  !> For forces of couplings.
  subroutine find_remedy_of_coupling(name, model, columns, remedy)
    character(len=*), intent(in) :: name          !< heading of the column
    type(model_type), intent(in) :: model         !< the model
    type(columns_type), intent(in) :: columns     !< of the run
    character(len=:), allocatable, intent(out) :: remedy   !< the end of the message; '' where there is none
    integer :: i, k, n

    remedy = ''
    k = number_after('C', name)
    if (k == 0) return
    n = 0
    if (allocated(model%mechanism%couplings)) n = size(model%mechanism%couplings)
    if (n == 0) then
      remedy = '; there are no couplings'
    else if (k > n) then
      remedy = '; the columns are C1'
      if (n == 1) remedy = '; the only such column is C1'
      do i = 2, n
        remedy = remedy//', C'//to_text(i)
      end do
    end if
    if (n > 0 .and. columns%couplings == 0) then
      if (remedy /= '') remedy = remedy//', with reactions=.true. in &output'
      if (remedy == '') remedy = set_in_output('reactions=.true.')
    end if
  end subroutine find_remedy_of_coupling

  !> The recorded column with the nearest heading.
  subroutine find_nearest(name, columns, remedy)
    character(len=*), intent(in) :: name          !< heading that is not recorded
    type(columns_type), intent(in) :: columns     !< of the run
    character(len=:), allocatable, intent(out) :: remedy   !< the end of the message; '' where there is none
    character(len=len(name) + 8) :: known(columns%count)
    integer :: i

    do i = 1, columns%count
      known(i) = columns%names(i)%text
    end do
    remedy = nearest_name(name, known)
    if (remedy /= '') then
      remedy = '; did you mean '''//trim(remedy)//'''?'
    else
      remedy = '; columns are the headings of the table, and &output decides which there are'
    end if
  end subroutine find_nearest
end module mech9_missing_column
