!> A mechanism: its structure, the geometry of its pairs, its masses and the loads on it, whatever problem is posed on it.
module mech9_mechanism
  use mech9_kinds, only: wp
  use mech9_structure, only: structure_type
  use mech9_pair, only: pair_slot_type
  use mech9_point, only: point_type
  use mech9_body, only: body_type
  use mech9_load, only: load_slot_type
  use mech9_coupling, only: coupling_slot_type
  implicit none
  private
  public :: mechanism_type

  !> Lengths in m, masses in kg, angles in rad inside the program, whatever unit the file uses.
  type :: mechanism_type
    character(len=:), allocatable :: title
    !> Radians in one unit of angle of the data file and of the results: 1, or pi/180.
    real(wp) :: angle_unit = 1.0_wp
    !> Allowed residual of redundant equations, for dimensions of few digits: a part of the mechanism's size, and rad.
    real(wp) :: data_tolerance = 0.0_wp
    type(structure_type) :: structure
    type(pair_slot_type), allocatable :: pairs(:)     !< pair k has coordinate k
    type(coupling_slot_type), allocatable :: couplings(:)   !< in the order of the data file; none where not allocated
    type(point_type), allocatable :: points(:)
    type(body_type), allocatable :: bodies(:)
    type(load_slot_type), allocatable :: loads(:)   !< in the order of the data file; motors are the last ones
    integer :: n_motors = 0                         !< how many of the loads are motors
    real(wp) :: gravity(3) = 0.0_wp                 !< in the axes of link 1 [m/s^2]
    real(wp), allocatable :: parameters(:)                  !< numbers for the user's procedures
  end type mechanism_type
end module mech9_mechanism
