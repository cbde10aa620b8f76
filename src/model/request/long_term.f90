!> Requests that concern the long-term motion: a section, Lyapunov exponents, periodic motions, and branches over a parameter.
module mech9_long_term
  use mech9_kinds, only: wp
  use mech9_error, only: place_type
  implicit none
  private
  public :: section_type, exponents_type, periodic_type, branch_request_type

  !> The points of a motion at which a coordinate or a column of the results has a value, or at the ends of periods.
  type :: section_type
    logical :: is_wanted = .false.             !< there is a group &section
    integer :: coordinate = 0                  !< number of the coordinate; 0: none
    character(len=:), allocatable :: column    !< heading of the column of the results; empty: none
    real(wp) :: period = 0.0_wp                !< time between two points; 0: a value gives the points [s]
    real(wp) :: value = 0.0_wp                 !< the value there, in the unit of the results
    integer :: direction = 1                   !< 1: met while it grows, -1: while it falls, 0: both
    logical :: every_turn = .false.            !< a value that differs by whole turns counts, too
    real(wp) :: transient = 0.0_wp             !< time from the start in which no point counts [s]
    character(len=:), allocatable :: table     !< name of the table's file; empty: none
    logical :: reduce_angles = .false.         !< pictures show angles within one turn
    type(place_type) :: place                  !< of its group in the data file
  end type section_type

  !> How Lyapunov exponents are found.
  type :: exponents_type
    real(wp) :: transient = 0.0_wp             !< time from the start before which nothing is summed [s]
    real(wp) :: time = 0.0_wp                  !< time over which is summed; 0: up to the end of the results [s]
    type(place_type) :: place                  !< of its group in the data file
  end type exponents_type

  !> How periodic motions are found.
  type :: periodic_type
    real(wp) :: period = 0.0_wp                !< of a driven motion, or a guess for that of a free one; 0: that of the drives [s]
    integer :: starts = 0                      !< random starts beside that of the data file
    type(place_type) :: place                  !< of its group in the data file
  end type periodic_type

  !> Branches of positions over a parameter.
  type :: branch_request_type
    character(len=:), allocatable :: parameter !< its name
    character(len=:), allocatable :: of        !< equilibrium, position or periodic; empty: the program decides
    logical :: has_low = .false.               !< `low` is given; else it is that of the parameter
    logical :: has_high = .false.              !< `high` is given
    real(wp) :: low = 0.0_wp                   !< least value of the parameter, in the units of the data file
    real(wp) :: high = 0.0_wp                  !< its largest value
    real(wp) :: step = 0.05_wp                 !< longest step [rad, lengths of the mechanism, ranges of the parameter]
    integer :: points = 1000                   !< largest number of points of a branch in each direction
    logical :: switch = .true.                 !< branches are followed from branch points
    type(place_type) :: place                  !< of its group in the data file
  end type branch_request_type
end module mech9_long_term
