!> A mechanism from values set in code. A design is the text of a data file in the making, so that finishing it checks
!> everything that the reader of data files checks, and every name of docs/reference/data-file.md can be given.
module mech9_design
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_text, only: to_text
  use mech9_checked_mechanism, only: checked_mechanism_type, read_text
  implicit none
  private
  public :: design_type

  type :: design_type
    private
    character(len=:), allocatable :: text    !< the groups so far
  contains
    procedure :: independent
    procedure, private :: simple_pair
    procedure, private :: compound_joint
    generic :: pair => simple_pair, compound_joint
    procedure :: coupling
    procedure :: initial
    procedure :: drive
    procedure :: body
    procedure :: gravity
    procedure :: point
    procedure :: time
    procedure :: tolerances
    procedure :: add
    procedure :: finish
  end type design_type

contains

  !> Say which coordinates are independent.
  pure subroutine independent(self, coordinates)
    class(design_type), intent(inout) :: self   !< the design
    integer, intent(in) :: coordinates(:)       !< their numbers

    call self%add('structure', 'cq='//integers(coordinates))
  end subroutine independent

  !> Add a pair. Points and directions are given in the system of the link that they belong to; those of the moving link are the
  !> same numbers as in the reference link unless given.
  pure subroutine simple_pair(self, coordinate, kind, links, point, axis, moving_point, moving_axis, zero, moving_zero, pitch, &
                              file, orientation)
    class(design_type), intent(inout) :: self             !< the design
    integer, intent(in) :: coordinate                     !< number of the pair's coordinate
    character(len=*), intent(in) :: kind                  !< 'revolute', 'prismatic', 'helical', 'path' or 'user'
    integer, intent(in) :: links(2)                       !< reference link and moving link; 1 is the frame
    real(wp), intent(in), optional :: point(3)            !< on the axis, in the reference link [m]
    real(wp), intent(in), optional :: axis(3)             !< direction of the axis in the reference link
    real(wp), intent(in), optional :: moving_point(3)     !< the same point in the moving link [m]
    real(wp), intent(in), optional :: moving_axis(3)      !< the same direction in the moving link
    real(wp), intent(in), optional :: zero(3)             !< direction from which angles count, in the reference link
    real(wp), intent(in), optional :: moving_zero(3)      !< direction in the moving link that lies on `zero` at angle 0
    real(wp), intent(in), optional :: pitch               !< advance per turn of a helical pair [m]
    character(len=*), intent(in), optional :: file         !< of the points of a path, from the current folder
    character(len=*), intent(in), optional :: orientation !< of the moving link along a path: 'fixed', the default, or 'tangent'
    character(len=:), allocatable :: names

    names = 'coordinate='//to_text(coordinate)//', kind='//quoted(kind)//', links='//integers(links)
    if (present(point)) names = names//', point='//reals(point)
    if (present(axis)) names = names//', axis='//reals(axis)
    if (present(moving_point)) names = names//', moving_point='//reals(moving_point)
    if (present(moving_axis)) names = names//', moving_axis='//reals(moving_axis)
    if (present(zero)) names = names//', zero='//reals(zero)
    if (present(moving_zero)) names = names//', moving_zero='//reals(moving_zero)
    if (present(pitch)) names = names//', pitch='//reals([pitch])
    if (present(file)) names = names//', file='//quoted(file)
    if (present(orientation)) names = names//', orientation='//quoted(orientation)
    call self%add('pair', names)
  end subroutine simple_pair

  !> Add a joint with several freedoms, as a pair with several coordinates. Points and directions as of other pairs.
  pure subroutine compound_joint(self, coordinates, kind, links, point, axis, moving_point, moving_axis, zero, moving_zero)
    class(design_type), intent(inout) :: self             !< the design
    integer, intent(in) :: coordinates(:)                 !< numbers of its coordinates, in the order of docs/how-to/model.md
    character(len=*), intent(in) :: kind                  !< 'spherical', 'universal', 'cylindrical', 'planar' or 'free'
    integer, intent(in) :: links(2)                       !< reference link and moving link; 1 is the frame
    real(wp), intent(in), optional :: point(3)            !< centre, or a point on the axis, in the reference link [m]
    real(wp), intent(in), optional :: axis(3)             !< direction of the axis in the reference link
    real(wp), intent(in), optional :: moving_point(3)     !< the same point in the moving link [m]
    real(wp), intent(in), optional :: moving_axis(3)      !< the same direction in the moving link; of a universal joint its second
                                                          !< axis
    real(wp), intent(in), optional :: zero(3)             !< direction from which angles count, in the reference link
    real(wp), intent(in), optional :: moving_zero(3)      !< direction in the moving link that lies on `zero` at angle 0
    character(len=:), allocatable :: names

    names = 'coordinates='//integers(coordinates)//', kind='//quoted(kind)//', links='//integers(links)
    if (present(point)) names = names//', point='//reals(point)
    if (present(axis)) names = names//', axis='//reals(axis)
    if (present(moving_point)) names = names//', moving_point='//reals(moving_point)
    if (present(moving_axis)) names = names//', moving_axis='//reals(moving_axis)
    if (present(zero)) names = names//', zero='//reals(zero)
    if (present(moving_zero)) names = names//', moving_zero='//reals(moving_zero)
    call self%add('pair', names)
  end subroutine compound_joint

  !> Couple coordinates, as gears, racks, belts and screws do. Which of the numbers are needed follows from the kind.
  pure subroutine coupling(self, kind, coordinates, ratio, radius, radii, crossed, pitch, phase, coefficients, constant, file)
    class(design_type), intent(inout) :: self               !< the design
    character(len=*), intent(in) :: kind                    !< 'gear', 'rack', 'belt', 'screw', 'linear', 'table' or 'user'
    integer, intent(in) :: coordinates(:)                   !< two numbers, of which the first moves the second; any for 'linear'
    real(wp), intent(in), optional :: ratio                 !< of a gear: change of the second coordinate per that of the first
    real(wp), intent(in), optional :: radius                !< of the pinion of a rack [m]
    real(wp), intent(in), optional :: radii(2)              !< of the pulleys of a belt [m]
    logical, intent(in), optional :: crossed                !< the belt is crossed
    real(wp), intent(in), optional :: pitch                 !< advance of a screw per turn [m]
    real(wp), intent(in), optional :: phase                 !< second coordinate where the first is zero; from `initial` if absent
    real(wp), intent(in), optional :: coefficients(:)       !< of the coordinates in a linear equation
    real(wp), intent(in), optional :: constant              !< their sum; 0 unless given
    character(len=*), intent(in), optional :: file          !< of a table, from the current folder
    character(len=:), allocatable :: names

    names = 'kind='//quoted(kind)//', coordinates='//integers(coordinates)
    if (present(ratio)) names = names//', ratio='//reals([ratio])
    if (present(radius)) names = names//', radius='//reals([radius])
    if (present(radii)) names = names//', radii='//reals(radii)
    if (present(crossed)) names = names//', crossed='//trim(merge('.true. ', '.false.', crossed))
    if (present(pitch)) names = names//', pitch='//reals([pitch])
    if (present(phase)) names = names//', phase='//reals([phase])
    if (present(coefficients)) names = names//', coefficients='//reals(coefficients)
    if (present(constant)) names = names//', constant='//reals([constant])
    if (present(file)) names = names//', file='//quoted(file)
    call self%add('coupling', names)
  end subroutine coupling

  !> Say where a coordinate starts: the position of an independent one in a free motion, or of a dependent one about there.
  pure subroutine initial(self, coordinate, position, velocity)
    class(design_type), intent(inout) :: self      !< the design
    integer, intent(in) :: coordinate              !< its number
    real(wp), intent(in) :: position               !< [rad, m]
    real(wp), intent(in), optional :: velocity     !< of an independent coordinate; 0 unless given [rad/s, m/s]

    if (present(velocity)) then
      call self%add('initial', 'coordinate='//to_text(coordinate)//', position='//reals([position])// &
                    ', velocity='//reals([velocity]))
    else
      call self%add('initial', 'coordinate='//to_text(coordinate)//', position='//reals([position]))
    end if
  end subroutine initial

  !> Drive an independent coordinate by a polynomial in time. Other drives are added by `add`.
  pure subroutine drive(self, coordinate, coefficients)
    class(design_type), intent(inout) :: self   !< the design
    integer, intent(in) :: coordinate           !< its number
    real(wp), intent(in) :: coefficients(:)     !< of t**0, t**1, ... [rad or m, per s, ...]

    call self%add('drive', 'coordinate='//to_text(coordinate)//', kind=''polynomial'', coefficients='//reals(coefficients))
  end subroutine drive

  !> Give a link mass.
  pure subroutine body(self, link, mass, centre, inertia)
    class(design_type), intent(inout) :: self         !< the design
    integer, intent(in) :: link                       !< its number
    real(wp), intent(in) :: mass                      !< [kg]
    real(wp), intent(in), optional :: centre(3)       !< centre of mass, in the link's system; its origin unless given [m]
    real(wp), intent(in), optional :: inertia(6)      !< xx, yy, zz, xy, xz, yz about the centre; 0 unless given [kg m^2]
    character(len=:), allocatable :: names

    names = 'link='//to_text(link)//', mass='//reals([mass])
    if (present(centre)) names = names//', centre='//reals(centre)
    if (present(inertia)) names = names//', inertia='//reals(inertia)
    call self%add('body', names)
  end subroutine body

  !> Set the acceleration of gravity; there is none unless it is set.
  pure subroutine gravity(self, acceleration)
    class(design_type), intent(inout) :: self    !< the design
    real(wp), intent(in) :: acceleration(3)      !< in the axes of link 1 [m/s^2]

    call self%add('gravity', 'acceleration='//reals(acceleration))
  end subroutine gravity

  !> Name a point of a link.
  pure subroutine point(self, name, link, position)
    class(design_type), intent(inout) :: self      !< the design
    character(len=*), intent(in) :: name           !< by which its motion is asked for
    integer, intent(in) :: link                    !< the link that it is part of
    real(wp), intent(in) :: position(3)            !< in the link's system [m]

    call self%add('point', 'name='//quoted(name)//', link='//to_text(link)//', position='//reals(position))
  end subroutine point

  !> Set when the motion starts, and the end up to which steps may go beyond a time that is asked for.
  pure subroutine time(self, start, end)
    class(design_type), intent(inout) :: self    !< the design
    real(wp), intent(in) :: start                !< 0 unless set [s]
    real(wp), intent(in) :: end                  !< 1 unless set; before the start for a motion backwards [s]

    call self%add('time', 'start='//reals([start])//', end='//reals([end]))
  end subroutine time

  !> Set how accurate each step of an integration is.
  pure subroutine tolerances(self, relative, absolute)
    class(design_type), intent(inout) :: self    !< the design
    real(wp), intent(in) :: relative             !< of each part of the state; 1e-8 unless set
    real(wp), intent(in) :: absolute             !< in the unit of each part; 1e-10 unless set

    call self%add('solver', 'relative_tolerance='//reals([relative])//', absolute_tolerance='//reals([absolute]))
  end subroutine tolerances

  !> Add any group of the data file, for example ('drive', "coordinate=1, kind='harmonic', amplitude=0.2, angular_frequency=3").
  pure subroutine add(self, group, names)
    class(design_type), intent(inout) :: self    !< the design
    character(len=*), intent(in) :: group        !< its name, as in docs/reference/data-file.md
    character(len=*), intent(in) :: names        !< its names with their values

    if (.not. allocated(self%text)) self%text = ''
    self%text = self%text//'&'//group//' '//names//' /'//new_line('a')
  end subroutine add

  !> The mechanism, checked as a data file is. Fails with exit_data or exit_structure; the message shows each wrong group.
  subroutine finish(self, mechanism, err)
    class(design_type), intent(in) :: self                     !< the design
    type(checked_mechanism_type), intent(out) :: mechanism     !< of use only where nothing failed
    type(error_type), allocatable, intent(out) :: err          !< allocated if it failed

    if (allocated(self%text)) then
      call read_text(self%text, mechanism, err)
    else
      call read_text('', mechanism, err)
    end if
  end subroutine finish

  !> Numbers as a list that is read back to the same bits.
  pure function reals(values) result(list)
    real(wp), intent(in) :: values(:)       !< the numbers
    character(len=26*size(values)) :: list
    integer :: i

    do i = 1, size(values)
      write (list(26*i - 25:26*i), '(es24.16e3,a)') values(i), ', '
    end do
    if (size(values) > 0) list(len(list) - 1:) = ''
  end function reals

  !> Integers as a list.
  pure function integers(values) result(list)
    integer, intent(in) :: values(:)        !< the numbers
    character(len=13*size(values)) :: list
    integer :: i

    do i = 1, size(values)
      write (list(13*i - 12:13*i), '(i11,a)') values(i), ', '
    end do
    if (size(values) > 0) list(len(list) - 1:) = ''
  end function integers

  !> A text in quotes, with those within it doubled.
  pure function quoted(text)
    character(len=*), intent(in) :: text                !< any text
    character(len=2*len_trim(text) + 2) :: quoted
    integer :: i, n

    quoted = ''''
    n = 1
    do i = 1, len_trim(text)
      quoted(n + 1:n + 1) = text(i:i)
      n = n + 1
      if (text(i:i) /= '''') cycle
      quoted(n + 1:n + 1) = ''''
      n = n + 1
    end do
    quoted(n + 1:n + 1) = ''''
  end function quoted
end module mech9_design
