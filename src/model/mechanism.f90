!> A mechanism: its structure, the geometry of its pairs, its masses and the loads on it, whatever problem is posed on it.
module mech9_mechanism
  use mech9_kinds, only: wp
  use mech9_units, only: units_type
  use mech9_part_names, only: part_names_type
  use mech9_structure, only: structure_type
  use mech9_pair, only: pair_slot_type
  use mech9_point, only: point_type
  use mech9_body, only: body_type
  use mech9_load, only: load_slot_type
  use mech9_motor, only: motor_slot_type
  use mech9_stop, only: stop_type
  use mech9_friction, only: friction_type
  use mech9_contact, only: contact_type
  use mech9_coupling, only: coupling_slot_type
  use mech9_registered_procedures, only: registered_procedures_type
  implicit none
  private
  public :: mechanism_type

  !> Lengths in m, masses in kg, forces in N, angles in rad inside the program, whatever units the file uses.
  type :: mechanism_type
    character(len=:), allocatable :: title
    type(units_type) :: units                         !< of the data file and of the results
    !> Allowed residual of redundant equations, for dimensions of few digits: a part of the mechanism's size, and rad.
    real(wp) :: data_tolerance = 0.0_wp
    type(structure_type) :: structure
    type(part_names_type) :: names                  !< of links and pairs, where the user gives any
    type(pair_slot_type), allocatable :: pairs(:)     !< pair k has coordinate k
    type(coupling_slot_type), allocatable :: couplings(:)   !< in the order of the data file; none where not allocated
    type(point_type), allocatable :: points(:)
    type(body_type), allocatable :: bodies(:)
    type(load_slot_type), allocatable :: loads(:)     !< in the order of the data file; then of frictions, stops, contacts
    type(motor_slot_type), allocatable :: motors(:)   !< in the order of the data file; their forces act beside those of the loads
    type(stop_type), allocatable :: stops(:)          !< in the order of the data file
    type(friction_type), allocatable :: frictions(:)  !< in the order of the data file; none where not allocated
    type(contact_type), allocatable :: contacts(:)    !< in the order of the data file; none where not allocated
    real(wp) :: gravity(3) = 0.0_wp                 !< in the axes of link 1 [m/s^2]
    real(wp), allocatable :: parameters(:)          !< numbers for the user's procedures
    type(registered_procedures_type) :: procedures  !< the user's procedures that are not linked
  contains
    procedure :: acting_loads
    procedure :: has_forces
    procedure :: mark_loaded_links
    procedure :: mark_loaded_coordinates
    procedure :: has_rigid_ends
    procedure :: has_frictions
    procedure :: has_contacts
  end type mechanism_type

contains

  !> Numbers of the loads that may move something.
  pure function acting_loads(self) result(acting)
    class(mechanism_type), intent(in) :: self   !< the mechanism
    integer, allocatable :: acting(:)
    integer :: i

    acting = pack([(i, i=1, size(self%loads))], [(.not. self%loads(i)%load%is_idle(), i=1, size(self%loads))])
  end function acting_loads

  !> Whether a load or a motor may move something.
  pure logical function has_forces(self)
    class(mechanism_type), intent(in) :: self   !< the mechanism
    integer :: i

    has_forces = size(self%motors) > 0
    do i = 1, size(self%loads)
      has_forces = has_forces .or. .not. self%loads(i)%load%is_idle()
    end do
  end function has_forces

  !> Mark the links on whose motion loads and motors depend or on which they act.
  pure subroutine mark_loaded_links(self, loaded)
    class(mechanism_type), intent(in) :: self   !< the mechanism
    logical, intent(inout) :: loaded(:)         !< (N) becomes true for these links; others stay
    integer :: i

    do i = 1, size(self%loads)
      if (.not. self%loads(i)%load%is_idle()) call self%loads(i)%load%mark_links(loaded)
    end do
    do i = 1, size(self%motors)
      call self%motors(i)%motor%mark_links(loaded)
    end do
  end subroutine mark_loaded_links

  !> Whether any stop, or any contact of links, is rigid.
  pure logical function has_rigid_ends(self)
    class(mechanism_type), intent(in) :: self   !< the mechanism

    has_rigid_ends = any(self%stops%is_rigid)
    if (allocated(self%contacts)) has_rigid_ends = has_rigid_ends .or. any(self%contacts%is_rigid)
  end function has_rigid_ends

  !> Whether any pair has friction.
  pure logical function has_frictions(self)
    class(mechanism_type), intent(in) :: self   !< the mechanism

    has_frictions = .false.
    if (allocated(self%frictions)) has_frictions = size(self%frictions) > 0
  end function has_frictions

  !> Whether any links may touch each other.
  pure logical function has_contacts(self)
    class(mechanism_type), intent(in) :: self   !< the mechanism

    has_contacts = .false.
    if (allocated(self%contacts)) has_contacts = size(self%contacts) > 0
  end function has_contacts

  !> Mark the coordinates on which loads and motors depend or act, and those that stops bound.
  pure subroutine mark_loaded_coordinates(self, loaded)
    class(mechanism_type), intent(in) :: self   !< the mechanism
    logical, intent(inout) :: loaded(:)         !< (M) becomes true for these coordinates; others stay
    integer :: i

    do i = 1, size(self%loads)
      if (.not. self%loads(i)%load%is_idle()) call self%loads(i)%load%mark_coordinates(loaded)
    end do
    do i = 1, size(self%motors)
      call self%motors(i)%motor%mark_coordinates(loaded)
    end do
    do i = 1, size(self%stops)
      loaded(self%stops(i)%coordinate) = .true.
    end do
  end subroutine mark_loaded_coordinates
end module mech9_mechanism
