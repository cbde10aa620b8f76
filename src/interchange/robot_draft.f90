!> A robot as the draft of a data file. Comments name its links and joints.
module mech9_robot_draft
  use mech9_kinds, only: wp
  use mech9_text, only: to_text
  use mech9_name_table, only: name_table_type
  use mech9_printable, only: printable, with_escapes
  use mech9_pose, only: default_zero
  use mech9_rotation, only: unit
  use mech9_draft, only: draft_type, draft_group_type, entry_type
  use mech9_robot, only: robot_type, robot_joint_type, helical_joint, universal_joint, spherical_joint, free_joint
  use mech9_pair_series, only: series_type
  implicit none
  private
  public :: draft_of_robot, number_text

  character, parameter :: eol = achar(10)
  !> Components of directions below this are round-off of sines and cosines.
  real(wp), parameter :: round_off = 4.0e-16_wp
  integer, parameter :: longest_name = 40
  character(len=*), parameter :: name_letters = 'abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_'

  !> The names that groups of one kind have so far.
  type :: used_names_type
    type(name_table_type) :: taken     !< the names
    type(name_table_type) :: tails     !< by names, the last number that stands behind one
  end type used_names_type

contains

  !> The draft. Each independent coordinate gets a drive that holds it, or initial values.
  subroutine draft_of_robot(robot, series, independent, q, with_drives, draft)
    type(robot_type), intent(in) :: robot      !< without fixed joints
    type(series_type), intent(in) :: series    !< its pairs
    logical, intent(in) :: independent(:)      !< (M) the coordinate is independent
    real(wp), intent(in) :: q(:)               !< (M) coordinates at the start [rad, m]
    logical, intent(in) :: with_drives         !< write drives in place of initial values
    type(draft_type), intent(out) :: draft     !< the data file
    type(draft_group_type), allocatable :: groups(:)
    type(used_names_type) :: names
    integer :: n, k

    allocate (draft%groups(4 + 5*size(q) + robot%n_points + 3*size(robot%links)))
    draft%head = ''
    n = 0
    call begin_group(draft, n, 'mechanism', '')
    if (robot%name /= '') call add(draft%groups(n), 'title', quoted(robot%name))
    call add(draft%groups(n), 'links', to_text(series%n_links))
    call add(draft%groups(n), 'coordinates', to_text(size(q)))
    call begin_group(draft, n, 'structure', '')
    call add(draft%groups(n), 'cq', to_text(pack([(k, k=1, size(q))], independent), ', '))
    call add_link_names(robot, series, draft, n)
    do k = 1, size(q)
      call add_pair(robot, series, k, names, draft, n)
    end do
    do k = 1, size(q)
      call add_coupling(robot, series, k, draft, n)
    end do
    do k = 1, size(q)
      if (independent(k) .and. with_drives) cycle
      call begin_group(draft, n, 'initial', '')
      call add(draft%groups(n), 'coordinate', to_text(k))
      call add(draft%groups(n), 'position', number_text(q(k)))
    end do
    call add_points(robot, series, draft, n)
    do k = 1, size(q)
      if (.not. (independent(k) .and. with_drives)) cycle
      call begin_group(draft, n, 'drive', '')
      call add(draft%groups(n), 'coordinate', to_text(k))
      call add(draft%groups(n), 'kind', "'polynomial'")
      call add(draft%groups(n), 'coefficients', number_text(q(k)))
    end do
    call add_bodies(robot, series, draft, n)
    call begin_group(draft, n, 'gravity', '')
    call add(draft%groups(n), 'acceleration', numbers_text(robot%gravity))
    call add_loads(robot, series, draft, n)
    allocate (groups(n))
    groups(:) = draft%groups(:n)
    call move_alloc(groups, draft%groups)
  end subroutine draft_of_robot

  !> Begin a group behind the others.
  subroutine begin_group(draft, n, name, comment)
    type(draft_type), intent(inout) :: draft  !< the data file
    integer, intent(inout) :: n               !< number of its groups
    character(len=*), intent(in) :: name      !< name of the group
    character(len=*), intent(in) :: comment   !< comment above it, without line end; empty: none

    n = n + 1
    draft%groups(n)%name = name
    draft%groups(n)%comment = ''
    if (comment /= '') draft%groups(n)%comment = '! '//printable(comment)//eol
    allocate (draft%groups(n)%entries(0))
  end subroutine begin_group

  !> Add a name with its values to a group.
  subroutine add(group, name, text)
    type(draft_group_type), intent(inout) :: group  !< the group
    character(len=*), intent(in) :: name            !< the name
    character(len=*), intent(in) :: text            !< its values, as a data file writes them
    type(entry_type), allocatable :: longer(:)
    integer :: n

    n = size(group%entries)
    allocate (longer(n + 1))
    longer(:n) = group%entries
    longer(n + 1)%name = name
    longer(n + 1)%text = text
    call move_alloc(longer, group%entries)
  end subroutine add

  !> Add the group of a pair, by its first coordinate. Directions of the moving link are given where they differ from those of the
  !> reference link.
  subroutine add_pair(robot, series, k, names, draft, n)
    type(robot_type), intent(in) :: robot     !< the robot
    type(series_type), intent(in) :: series   !< its pairs
    integer, intent(in) :: k                  !< number of the coordinate
    type(used_names_type), intent(inout) :: names   !< of pairs so far
    type(draft_type), intent(inout) :: draft  !< the data file
    integer, intent(inout) :: n               !< number of its groups
    character(len=*), parameter :: kinds(8) = [character(len=11) :: 'revolute', 'prismatic', 'helical', 'cylindrical', &
                                               'universal', 'spherical', 'planar', 'free']
    real(wp) :: axis(3), zero(3), axes(3, 2), zeros(3, 2)
    character(len=:), allocatable :: name
    logical :: differ
    integer :: i

    associate (pair => series%pairs(k), joint => robot%joints(series%pairs(k)%joint))
      if (pair%freedoms == 0) return
      axis = pair%axis
      zero = default_zero(axis)
      zero = unit(zero - dot_product(zero, axis)*axis)
      if (pair%kind == spherical_joint .or. pair%kind == free_joint) then
        axis = [0.0_wp, 0.0_wp, 1.0_wp]
        zero = [1.0_wp, 0.0_wp, 0.0_wp]
      end if
      do i = 1, 2
        axes(:, i) = tidy(matmul(pair%frames(i)%r, axis))
        zeros(:, i) = tidy(matmul(pair%frames(i)%r, zero))
      end do
      differ = any(abs(axes(:, 1) - axes(:, 2)) + abs(zeros(:, 1) - zeros(:, 2)) > 0.0_wp)
      if (pair%kind == universal_joint) then
        axes(:, 2) = tidy(matmul(pair%frames(2)%r, joint%second))
        differ = .true.
      end if
      call begin_group(draft, n, 'pair', pair_comment(series, k, joint))
      if (pair%freedoms > 1) then
        call add(draft%groups(n), 'coordinates', to_text([(i, i=k, k + pair%freedoms - 1)], ', '))
      else
        call add(draft%groups(n), 'coordinate', to_text(k))
      end if
      call add(draft%groups(n), 'links', to_text(pair%links, ', '))
      call add(draft%groups(n), 'kind', "'"//trim(kinds(pair%kind))//"'")
      if (joint%name /= '') then
        call find_free_name(joint%name, 'pair', names, name)
        call add(draft%groups(n), 'name', "'"//name//"'")
      end if
      if (pair%kind == helical_joint) call add(draft%groups(n), 'pitch', number_text(joint%pitch))
      call add(draft%groups(n), 'point', numbers_text(pair%frames(1)%p))
      call add(draft%groups(n), 'axis', numbers_text(axes(:, 1)))
      if (pair%kind /= universal_joint .and. (differ .or. pair%freedoms > 1)) &
        call add(draft%groups(n), 'zero', numbers_text(zeros(:, 1)))
      call add(draft%groups(n), 'moving_point', numbers_text(pair%frames(2)%p))
      if (differ) call add(draft%groups(n), 'moving_axis', numbers_text(axes(:, 2)))
      if (differ .and. pair%kind /= universal_joint) call add(draft%groups(n), 'moving_zero', numbers_text(zeros(:, 2)))
    end associate
  end subroutine add_pair

  !> Add the coupling of a coordinate that follows another one.
  subroutine add_coupling(robot, series, k, draft, n)
    type(robot_type), intent(in) :: robot     !< the robot
    type(series_type), intent(in) :: series   !< its pairs
    integer, intent(in) :: k                  !< number of the coordinate
    type(draft_type), intent(inout) :: draft  !< the data file
    integer, intent(inout) :: n               !< number of its groups
    integer :: leader

    leader = robot%leader_of(series%pairs(k)%joint)
    if (leader == 0) return
    associate (joint => robot%joints(series%pairs(k)%joint))
      call begin_group(draft, n, 'coupling', 'joint '//joint%name//' follows joint '//joint%leader)
      call add(draft%groups(n), 'kind', "'linear'")
      call add(draft%groups(n), 'coordinates', to_text([k, findloc(series%pairs%joint, leader, dim=1)], ', '))
      call add(draft%groups(n), 'coefficients', numbers_text([1.0_wp, -joint%ratio]))
      call add(draft%groups(n), 'constant', number_text(joint%offset))
    end associate
  end subroutine add_coupling

  !> The comment on a pair: its joint and the range of that.
  function pair_comment(series, k, joint) result(text)
    type(series_type), intent(in) :: series       !< all pairs
    integer, intent(in) :: k                      !< number of its first coordinate
    type(robot_joint_type), intent(in) :: joint   !< its joint
    character(len=:), allocatable :: text
    integer :: first, last

    text = 'joint '//joint%name
    first = findloc(series%pairs%joint, series%pairs(k)%joint, dim=1)
    last = findloc(series%pairs%joint, series%pairs(k)%joint, dim=1, back=.true.)
    if (count(series%pairs(first:last)%freedoms > 0) > 1) text = text//', turn '//to_text(k - first + 1)//' of 2'
    if (series%closes(series%pairs(k)%joint)) text = text//', which closes a chain'
    if (allocated(joint%remark)) text = text//'; '//joint%remark
    if (joint%has_range) text = text//', range '//number_text(joint%range(1))//' to '//number_text(joint%range(2))
  end function pair_comment

  !> Add the points: those of the robot, and the origins of links at which open chains end.
  subroutine add_points(robot, series, draft, n)
    type(robot_type), intent(in) :: robot     !< the robot
    type(series_type), intent(in) :: series   !< its pairs
    type(draft_type), intent(inout) :: draft  !< the data file
    integer, intent(inout) :: n               !< number of its groups
    type(used_names_type) :: names
    logical :: bears(size(robot%links))
    integer :: i

    bears = .false.
    do i = 1, robot%n_points
      bears(robot%points(i)%link) = .true.
      if (robot%points(i)%link > 1) &
        call add_point(robot%points(i)%name, series%number_of(robot%points(i)%link), robot%points(i)%position, names, &
                       draft, n)
    end do
    do i = 2, size(robot%links)
      if (bears(i)) cycle
      if (count(series%pairs%freedoms > 0 .and. (series%pairs%links(1) == series%number_of(i) .or. &
                                                 series%pairs%links(2) == series%number_of(i))) > 1) cycle
      call add_point(robot%links(i)%name, series%number_of(i), [0.0_wp, 0.0_wp, 0.0_wp], names, draft, n)
    end do
  end subroutine add_points

  !> Add the group of a point, whose name is made of letters that names may have, and different from those before.
  subroutine add_point(name, link, position, names, draft, n)
    character(len=*), intent(in) :: name      !< name in the robot
    integer, intent(in) :: link               !< number of the link
    real(wp), intent(in) :: position(3)       !< in the frame of the link [m]
    type(used_names_type), intent(inout) :: names   !< of points so far
    type(draft_type), intent(inout) :: draft  !< the data file
    integer, intent(inout) :: n               !< number of its groups
    character(len=:), allocatable :: free

    call find_free_name(name, 'point', names, free)
    call begin_group(draft, n, 'point', '')
    call add(draft%groups(n), 'name', "'"//free//"'")
    call add(draft%groups(n), 'link', to_text(link))
    call add(draft%groups(n), 'position', numbers_text(position))
  end subroutine add_point

  !> Add the groups with the names of links.
  subroutine add_link_names(robot, series, draft, n)
    type(robot_type), intent(in) :: robot     !< the robot
    type(series_type), intent(in) :: series   !< its pairs
    type(draft_type), intent(inout) :: draft  !< the data file
    integer, intent(inout) :: n               !< number of its groups
    type(used_names_type) :: names
    character(len=:), allocatable :: name
    integer :: i

    do i = 1, size(robot%links)
      if (robot%links(i)%name == '') cycle
      call find_free_name(robot%links(i)%name, 'link', names, name)
      call begin_group(draft, n, 'link', '')
      call add(draft%groups(n), 'number', to_text(series%number_of(i)))
      call add(draft%groups(n), 'name', "'"//name//"'")
    end do
  end subroutine add_link_names

  !> Form a name of letters that names may have, which begins with no digit and is different from those before.
  subroutine find_free_name(name, default, names, free)
    character(len=*), intent(in) :: name                    !< name in the robot
    character(len=*), intent(in) :: default                 !< for a name without letters
    type(used_names_type), intent(inout) :: names           !< so far; gets this one
    character(len=:), allocatable, intent(out) :: free      !< the name
    character(len=:), allocatable :: plain
    integer :: i, tail

    plain = name(:min(len(name), longest_name - 6))
    do i = 1, len(plain)
      if (index(name_letters, plain(i:i)) == 0) plain(i:i) = '_'
    end do
    if (plain == '') plain = default
    if (default /= 'point' .and. scan(plain(1:1), '0123456789') == 1) plain = '_'//plain
    ! columns of links begin with L2, those of pairs with R2
    if (any(default//plain(1:1) == [character(len=5) :: 'linkL', 'pairR']) .and. verify(plain(2:), '0123456789') == 0) &
      plain = plain//'_'
    free = plain
    tail = max(1, names%tails%find(plain))
    do while (names%taken%find(free) > 0)
      tail = tail + 1
      free = plain//'_'//to_text(tail)
    end do
    call names%taken%add(free, 1)
    call names%tails%set(plain, tail)
  end subroutine find_free_name

  !> Add the groups of bodies, but for the frame, whose mass has no effect.
  subroutine add_bodies(robot, series, draft, n)
    type(robot_type), intent(in) :: robot     !< the robot
    type(series_type), intent(in) :: series   !< its pairs
    type(draft_type), intent(inout) :: draft  !< the data file
    integer, intent(inout) :: n               !< number of its groups
    integer :: i

    do i = 2, size(robot%links)
      associate (link => robot%links(i), j => robot%links(i)%inertia)
        if (.not. (link%mass > 0.0_wp .or. any(abs(j) > 0.0_wp))) cycle
        call begin_group(draft, n, 'body', 'link '//link%name)
        call add(draft%groups(n), 'link', to_text(series%number_of(i)))
        call add(draft%groups(n), 'mass', number_text(link%mass))
        call add(draft%groups(n), 'centre', numbers_text(link%centre))
        call add(draft%groups(n), 'inertia', numbers_text([j(1, 1), j(2, 2), j(3, 3), j(1, 2), j(1, 3), j(2, 3)]))
      end associate
    end do
  end subroutine add_bodies

  !> Add springs and dampers on coordinates.
  subroutine add_loads(robot, series, draft, n)
    type(robot_type), intent(in) :: robot     !< the robot
    type(series_type), intent(in) :: series   !< its pairs
    type(draft_type), intent(inout) :: draft  !< the data file
    integer, intent(inout) :: n               !< number of its groups
    integer :: k

    do k = 1, size(series%pairs)
      associate (joint => robot%joints(series%pairs(k)%joint))
        if (.not. (joint%stiffness > 0.0_wp .or. joint%damping > 0.0_wp)) cycle
        call begin_group(draft, n, 'load', 'joint '//joint%name)
        call add(draft%groups(n), 'kind', "'coordinate'")
        call add(draft%groups(n), 'coordinate', to_text(k))
        if (joint%stiffness > 0.0_wp) then
          call add(draft%groups(n), 'stiffness', number_text(joint%stiffness))
          call add(draft%groups(n), 'rest', number_text(joint%rest))
        end if
        if (joint%damping > 0.0_wp) call add(draft%groups(n), 'damping', number_text(joint%damping))
      end associate
    end do
  end subroutine add_loads

  !> A direction without round-off beside its zeros and ones.
  pure function tidy(direction) result(clean)
    real(wp), intent(in) :: direction(3)  !< of length one
    real(wp) :: clean(3)

    clean = merge(0.0_wp, direction, abs(direction) < round_off)
    where (abs(abs(clean) - 1.0_wp) < round_off) clean = sign(1.0_wp, clean)
  end function tidy

  !> A text in quotes, as a data file writes it.
  pure function quoted(text) result(safe)
    character(len=*), intent(in) :: text  !< any bytes
    character(len=:), allocatable :: safe

    safe = "'"//with_escapes(printable(text), "'", ["''"])//"'"
  end function quoted

  !> Numbers with commas between them.
  function numbers_text(numbers) result(text)
    real(wp), intent(in) :: numbers(:)  !< the numbers
    character(len=:), allocatable :: text
    integer :: i

    text = ''
    do i = 1, size(numbers)
      text = text//number_text(numbers(i))
      if (i < size(numbers)) text = text//', '
    end do
  end function numbers_text

  !> A number with as few digits as tell it exactly.
  function number_text(number) result(text)
    real(wp), intent(in) :: number  !< any finite number
    character(len=:), allocatable :: text
    real(wp) :: back
    integer :: digits

    do digits = 6, 17
      text = to_text(number, digits)
      read (text, *) back
      if (.not. abs(back - number) > 0.0_wp) return
    end do
  end function number_text
end module mech9_robot_draft
