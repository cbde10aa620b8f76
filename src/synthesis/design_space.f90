!> The designs of a synthesis: a mechanism as a function of the parameters that are varied between bounds.
!>
!> The structure, the blocks and the size of the plan stay as they are; only its numbers change. Where all numbers are affine
!> functions of the parameters, as lengths are, they follow without the readers of the data file.
module mech9_design_space
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_structure
  use mech9_pose, only: pose_type
  use mech9_law, only: drive_slot_type
  use mech9_polynomial_law, only: polynomial_law_type
  use mech9_model, only: model_type
  use mech9_variable_model, only: variable_model_type
  use mech9_plan, only: plan_type
  use mech9_arithmetics, only: set_in_space, set_in_plane
  use mech9_planar_layout, only: lay_out_in_plane
  use mech9_counted_random, only: uniform_at
  use mech9_mechanism_constants, only: gather_constants, align_axes, constants_of_coordinate, constants_of_pose
  use mech9_tangent, only: tangent_type, find_tangent
  use mech9_run_evaluator, only: run_evaluator_type
  implicit none
  private
  public :: design_space_type, design_type, new_design_space, new_design, place_design, place_drives, find_tangents, &
    drive_changes, copy_design, fix_design_space, all_values, probe, probes

  !> The data that all designs share. A copy needs a copy of the model as a function.
  type :: design_space_type
    class(variable_model_type), pointer :: variable => null()   !< the model as a function of all parameters
    class(model_type), allocatable :: model         !< with the values of the data file
    class(plan_type), allocatable :: plan           !< its plan
    integer, allocatable :: varied(:)               !< numbers of the parameters that are varied
    real(wp), allocatable :: low(:)                 !< least value of each
    real(wp), allocatable :: high(:)                !< largest value of each
    real(wp), allocatable :: values(:)              !< values of all parameters in the data file
    logical :: in_plane = .false.                   !< all designs move in one plane, see judge_plane
    logical :: is_affine = .false.                  !< all numbers are affine functions of the parameters, and are set without readers
    logical, allocatable :: is_constant(:)          !< (varied) the derivatives by this parameter are constant
    real(wp), allocatable :: constants(:)           !< numbers of the model, in the order of mech9_mechanism_constants
    real(wp), allocatable :: slopes(:, :)           !< (constants,varied) their derivatives, where they are affine
    type(tangent_type), allocatable :: tangents(:)  !< (varied) the same as tangents
    integer :: drives_at = 0                        !< number of constants before those of the drives
    type(run_evaluator_type), allocatable :: evaluator   !< makes the runs from which quantities are taken
  contains
    procedure :: moves_drives
  end type design_space_type

  !> One design.
  type :: design_type
    real(wp), allocatable :: x(:)                  !< values of the varied parameters
    class(plan_type), allocatable :: plan          !< in the arithmetic of its motion
    class(plan_type), allocatable :: in_space      !< the same in space
    real(wp), allocatable :: places(:, :)          !< (3,points) of the points in their links [m]
    type(drive_slot_type), allocatable :: drives(:)
    type(tangent_type), allocatable :: tangents(:) !< (varied) derivatives of its numbers, where these have been found
  end type design_type

  !> Numbers are affine where they differ by no more than this part of their largest change from an affine function.
  real(wp), parameter :: affine = 1.0e-11_wp
  integer, parameter :: probes = 4   !< points of the box at which this is judged

contains

  !> Prepare the designs between the bounds of the parameters. Fails where a design has no derivatives by them.
  subroutine new_design_space(variable, model, plan, space, err)
    class(variable_model_type), intent(inout), target :: variable   !< the model as a function of its parameters
    type(model_type), intent(in) :: model                           !< with the values of the data file
    type(plan_type), intent(in) :: plan                             !< its plan
    type(design_space_type), intent(out) :: space                   !< prepared
    type(error_type), allocatable, intent(out) :: err               !< allocated if it failed
    integer :: i

    space%variable => variable
    allocate (space%model, source=model)
    allocate (space%plan, source=plan)
    space%varied = pack([(i, i=1, size(model%parameters))], model%parameters%has_range)
    space%low = model%parameters(space%varied)%low
    space%high = model%parameters(space%varied)%high
    space%values = model%parameters%value
    call gather_constants(model, plan%length, plan%origin, space%constants)
    space%drives_at = constants_of_coordinate*plan%n_coordinates + constants_of_pose*plan%n_links &
                      + 3*size(model%mechanism%points)
    allocate (space%tangents(size(space%varied)))
    do i = 1, size(space%varied)
      call find_tangent(variable, model, plan, space%varied(i), space%tangents(i), err)
      if (allocated(err)) return
    end do
    call judge_affinity(space)
    space%in_plane = plan%planar%used
  end subroutine new_design_space

  !> Prepare one design alone: the one of its model, with its plan.
  subroutine fix_design_space(space)
    type(design_space_type), intent(inout) :: space   !< with model, plan, values and tangents

    call gather_constants(space%model, space%plan%length, space%plan%origin, space%constants)
    space%drives_at = constants_of_coordinate*space%plan%n_coordinates + constants_of_pose*space%plan%n_links &
                      + 3*size(space%model%mechanism%points)
    allocate (space%slopes(size(space%constants), size(space%varied)), source=0.0_wp)
    space%is_affine = .true.
    space%in_plane = space%plan%planar%used
  end subroutine fix_design_space

  !> Find out whether the numbers of the model are affine functions of the parameters, and their slopes.
  subroutine judge_affinity(space)
    type(design_space_type), intent(inout) :: space   !< gets the slopes
    real(wp), allocatable :: above(:), below(:)
    real(wp) :: x(size(space%varied)), largest
    integer :: i

    allocate (space%is_constant(size(space%varied)), source=.false.)
    allocate (space%slopes(size(space%constants), size(space%varied)))
    do i = 1, size(x)
      ! formulas may be affine in a part of the box alone
      if (allocated(space%model%parameters(space%varied(i))%through)) then
        if (size(space%model%parameters(space%varied(i))%through) > 0) return
      end if
      x = space%values(space%varied)
      x(i) = space%high(i)
      call constants_at(space, x, above)
      x(i) = space%low(i)
      call constants_at(space, x, below)
      if (size(above) /= size(space%constants) .or. size(below) /= size(above)) return
      space%slopes(:, i) = (above - below)/(space%high(i) - space%low(i))
    end do
    ! a drive of another kind cannot be given its numbers
    do i = 1, size(space%model%problem%drives)
      associate (drive => space%model%problem%drives(i)%drive)
        select type (drive)
        type is (polynomial_law_type)
          cycle
        class default
          if (any(abs(space%slopes(space%drives_at + 1:, :)) > 0.0_wp)) return
        end select
      end associate
    end do
    call judge_each(space)
    do i = 1, size(space%tangents)
      ! nor can couplings and the curves of pairs
      if (any(space%tangents(i)%couplings%varies) .or. any(space%tangents(i)%pairs%varies)) return
    end do
    do i = 1, probes
      x = probe(space, i)
      call constants_at(space, x, above)
      if (size(above) /= size(space%constants)) return
      below = space%constants + matmul(space%slopes, x - space%values(space%varied))
      largest = max(maxval(abs(above)), maxval(abs(below)))
      if (any(abs(above - below) > affine*largest)) return
    end do
    space%is_affine = .true.
  end subroutine judge_affinity

  !> Find out which parameters have constant derivatives: over their whole range, from any place in the ranges of the others.
  subroutine judge_each(space)
    type(design_space_type), intent(inout) :: space   !< with the slopes over the ranges
    real(wp), allocatable :: values(:), slope(:), below(:)
    real(wp) :: x(size(space%varied)), ends(3), largest
    integer :: i, j, k

    do i = 1, size(x)
      space%is_constant(i) = .true.
      do j = 1, probes
        x = probe(space, j)
        ends = [space%low(i), x(i), space%high(i)]
        x(i) = ends(1)
        call constants_at(space, x, below)
        if (size(below) /= size(space%constants)) space%is_constant(i) = .false.
        do k = 2, 3
          if (.not. space%is_constant(i)) exit
          x(i) = ends(k)
          call constants_at(space, x, values)
          if (size(values) /= size(below)) then
            space%is_constant(i) = .false.
          else
            slope = values - below - space%slopes(:, i)*(ends(k) - ends(1))
            largest = max(maxval(abs(values)), maxval(abs(below)))
            space%is_constant(i) = all(abs(slope) <= affine*largest)
          end if
        end do
        if (.not. space%is_constant(i)) exit
      end do
    end do
  end subroutine judge_each

  !> A place between all bounds.
  pure function probe(space, number) result(x)
    type(design_space_type), intent(in) :: space   !< the designs
    integer, intent(in) :: number                  !< of the place, from 1
    real(wp) :: x(size(space%varied))
    integer :: j

    do j = 1, size(x)
      x(j) = space%low(j) + uniform_at(1, number, j)*(space%high(j) - space%low(j))
    end do
  end function probe

  !> The numbers of the model at some values of the varied parameters; none where there is no such model.
  subroutine constants_at(space, x, constants)
    type(design_space_type), intent(inout) :: space           !< the designs
    real(wp), intent(in) :: x(:)                              !< values of the varied parameters
    real(wp), allocatable, intent(out) :: constants(:)        !< the numbers
    type(model_type) :: model
    type(error_type), allocatable :: err

    call space%variable%at(all_values(space, x), model, err)
    if (allocated(err)) then
      allocate (constants(0))
    else
      call align_axes(space%model, model)
      call gather_constants(model, space%plan%length, space%plan%origin, constants)
    end if
  end subroutine constants_at

  !> The values of all parameters.
  pure function all_values(space, x) result(values)
    type(design_space_type), intent(in) :: space   !< the designs
    real(wp), intent(in) :: x(:)                   !< values of the varied ones
    real(wp) :: values(size(space%values))

    values = space%values
    values(space%varied) = x
  end function all_values

  !> Whether a varied parameter sets a number of a drive.
  pure logical function moves_drives(self)
    class(design_space_type), intent(in) :: self   !< the designs
    integer :: i

    moves_drives = any([(any(self%tangents(i)%drives%varies), i=1, size(self%tangents))])
  end function moves_drives

  !> A design that is not placed yet.
  subroutine new_design(space, design)
    type(design_space_type), intent(in) :: space   !< the designs
    type(design_type), intent(out) :: design       !< with the numbers of the data file
    integer :: i

    design%x = space%values(space%varied)
    allocate (design%in_space, source=space%plan)
    design%in_space%blocks%arithmetic = 1
    design%in_space%blocks%is_shown = .false.
    call set_in_space(design%in_space)
    if (space%in_plane) then
      allocate (design%plan, source=space%plan)
    else
      allocate (design%plan, source=design%in_space)
    end if
    design%drives = space%model%problem%drives
    allocate (design%places(3, size(space%model%mechanism%points)))
    do i = 1, size(space%model%mechanism%points)
      design%places(:, i) = space%model%mechanism%points(i)%position
    end do
    design%tangents = space%tangents
  end subroutine new_design

  !> Copy a design. The assignment stands here alone, because compilers write it out for all components.
  subroutine copy_design(from, to)
    type(design_type), intent(in) :: from    !< the design
    type(design_type), intent(inout) :: to   !< the same afterwards

    to = from
  end subroutine copy_design

  !> Give a design the values of its parameters. Fails where there is no model with these values, and where the design leaves the plane
  !> in which all designs move.
  subroutine place_design(space, x, design, err)
    type(design_space_type), intent(inout) :: space       !< the designs
    real(wp), intent(in) :: x(:)                          !< values of the varied parameters
    type(design_type), intent(inout) :: design            !< gets its numbers
    type(error_type), allocatable, intent(out) :: err     !< allocated if it failed
    real(wp), allocatable :: row(:)
    type(model_type) :: model

    design%x = x
    if (space%is_affine) then
      row = space%constants + matmul(space%slopes, x - space%values(space%varied))
      call place_drives(space, x, design)
    else
      call space%variable%at(all_values(space, x), model, err)
      if (allocated(err)) return
      call align_axes(space%model, model)
      call gather_constants(model, space%plan%length, space%plan%origin, row)
      design%drives = model%problem%drives
      call place_curves(model, design)
    end if
    call place_constants(row, space%in_plane, design, err)
  end subroutine place_design

  !> Give the drives of a design their numbers, which are affine functions of the parameters. Only polynomials change with them.
  pure subroutine place_drives(space, x, design)
    type(design_space_type), intent(in) :: space         !< the designs
    real(wp), intent(in) :: x(:)                         !< values of the varied parameters
    type(design_type), intent(inout) :: design           !< gets the numbers of its drives
    real(wp), allocatable :: others(:)
    integer :: i, j, at

    at = space%drives_at
    do i = 1, size(design%drives)
      associate (drive => design%drives(i)%drive)
        select type (drive)
        type is (polynomial_law_type)
          do j = 1, size(drive%coefficients)
            drive%coefficients(j) = space%constants(at + j) &
                                    + dot_product(space%slopes(at + j, :), x - space%values(space%varied))
          end do
          at = at + size(drive%coefficients)
        class default
          call drive%constants(others)
          if (allocated(others)) at = at + size(others)
        end select
      end associate
    end do
  end subroutine place_drives

  !> Set the couplings of a design's plans, and the pairs without a fixed axis.
  pure subroutine place_curves(model, design)
    type(model_type), intent(in) :: model         !< with the values of the design
    type(design_type), intent(inout) :: design    !< gets them
    integer :: k

    associate (plan => design%in_space)
      if (allocated(plan%couplings)) plan%couplings = model%mechanism%couplings
      do k = 1, plan%n_coordinates
        if (.not. plan%steps(plan%step_of(k))%is_screw) plan%pairs(k) = model%mechanism%pairs(k)
      end do
      design%plan%couplings = plan%couplings
      design%plan%pairs = plan%pairs
    end associate
  end subroutine place_curves

  !> Set the numbers of a design's plans and points. Fails where the design leaves its plane.
  subroutine place_constants(row, in_plane, design, err)
    real(wp), intent(in) :: row(:)                      !< the numbers, in the order of mech9_mechanism_constants
    logical, intent(in) :: in_plane                     !< the design moves in its plane
    type(design_type), intent(inout) :: design          !< gets them
    type(error_type), allocatable, intent(out) :: err   !< allocated if it leaves the plane
    integer :: s, k, c, at, i

    associate (plan => design%in_space)
      do s = 1, plan%n_coordinates
        at = constants_of_coordinate*(plan%steps(s)%coordinate - 1)
        plan%steps(s)%before = pose_of(row(at + 1:at + 12))
        plan%steps(s)%offset = row(at + 13)
        plan%steps(s)%slide = row(at + 14)
      end do
      do c = 1, size(plan%closures)
        if (plan%closures(c)%coupling > 0) cycle
        k = plan%steps(plan%closures(c)%closing)%coordinate
        at = constants_of_coordinate*(k - 1) + 14
        plan%closures(c)%in_target = pose_of(row(at + 1:at + 12))
      end do
      at = constants_of_coordinate*plan%n_coordinates
      do i = 1, plan%n_links
        plan%link_in_frame(i) = pose_of(row(at + 1:at + 12))
        at = at + constants_of_pose
      end do
      design%places = reshape(row(at + 1:at + size(design%places)), shape(design%places))
      design%plan%steps = plan%steps
      design%plan%closures = plan%closures
      design%plan%link_in_frame = plan%link_in_frame
    end associate
    if (.not. in_plane) return
    call lay_out_in_plane(design%plan)
    call set_in_plane(design%plan)
    if (.not. design%plan%planar%used) call raise(err, exit_structure, design%plan%planar%why_not%kind)
  end subroutine place_constants

  !> A pose from its numbers.
  pure function pose_of(numbers) result(pose)
    real(wp), intent(in) :: numbers(12)   !< its rotation by columns, and its origin
    type(pose_type) :: pose

    pose%r = reshape(numbers(:9), [3, 3])
    pose%p = numbers(10:12)
  end function pose_of

  !> Find the derivatives of the numbers of a design by the varied parameters. They are constant where the numbers are affine.
  subroutine find_tangents(space, design, err)
    type(design_space_type), intent(inout) :: space       !< the designs
    type(design_type), intent(inout) :: design            !< placed; gets the derivatives
    type(error_type), allocatable, intent(out) :: err     !< allocated if it failed
    type(model_type) :: model
    integer :: i

    if (space%is_affine) return
    call space%variable%at(all_values(space, design%x), model, err)
    do i = 1, size(design%tangents)
      if (allocated(err)) return
      if (space%is_constant(i)) cycle
      call find_tangent(space%variable, model, design%in_space, space%varied(i), design%tangents(i), err)
    end do
  end subroutine find_tangents

  !> The derivatives of a driven coordinate by the parameters at a time.
  subroutine drive_changes(design, number, t, change)
    type(design_type), intent(in) :: design   !< placed, with its tangents
    integer, intent(in) :: number             !< of the drive
    real(wp), intent(in) :: t                 !< time [s]
    real(wp), intent(out) :: change(:)        !< (n) of the coordinate [rad, m]
    real(wp) :: rate, acceleration
    integer :: p

    change = 0.0_wp
    do p = 1, size(change)
      associate (part => design%tangents(p)%drives(number))
        if (part%varies) call design%drives(number)%drive%vary(part%change, t, change(p), rate, acceleration)
      end associate
    end do
  end subroutine drive_changes
end module mech9_design_space
