!> A mechanism holds all data of a data file, checked. It never changes once it is read.
module mech9_mechanism
  use mech9_kinds, only: wp
  use mech9_structure, only: structure_type
  use mech9_structural_vectors, only: structural_vectors_type
  use mech9_pair, only: pair_slot_type
  use mech9_drive, only: drive_slot_type
  use mech9_point, only: point_type
  use mech9_body, only: body_type
  use mech9_load, only: load_slot_type
  use mech9_settings, only: time_grid_type, solver_settings_type, output_settings_type
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
    !> The order of computation, from the data file or made from the structure.
    type(structural_vectors_type) :: vectors
    type(pair_slot_type), allocatable :: pairs(:)     !< pair k has coordinate k
    type(drive_slot_type), allocatable :: drives(:)   !< in the order of the data file
    real(wp), allocatable :: initial_position(:)      !< (M) values of independent, guesses of dependent ones [rad, m]
    real(wp), allocatable :: initial_velocity(:)      !< (M) of independent coordinates [rad/s, m/s]
    logical, allocatable :: position_given(:)         !< (M) the data file gives the position
    logical, allocatable :: velocity_given(:)         !< (M) the data file gives the velocity
    type(point_type), allocatable :: points(:)
    type(body_type), allocatable :: bodies(:)
    type(load_slot_type), allocatable :: loads(:)   !< in the order of the data file
    real(wp) :: gravity(3) = 0.0_wp                 !< in the axes of link 1 [m/s^2]
    type(time_grid_type) :: time
    type(solver_settings_type) :: solver
    type(output_settings_type) :: output
    real(wp), allocatable :: parameters(:)                  !< numbers for the user's procedures
  end type mechanism_type
end module mech9_mechanism
