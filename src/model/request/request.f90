!> The request: the times of the results, their accuracy, where they go, the quantities that are taken of them, the cams whose
!> profiles are computed, and what is asked about the long-term motion.
module mech9_request
  use mech9_kinds, only: wp
  use mech9_error, only: place_type
  use mech9_quantity, only: quantity_type
  use mech9_study, only: study_type
  use mech9_long_term, only: section_type, exponents_type, periodic_type, branch_request_type
  use mech9_objective, only: objective_type, limit_type, optimum_type
  implicit none
  private
  public :: request_type, time_grid_type, solver_settings_type, output_settings_type, cam_request_type

  !> Results are given at start + (end - start) i/intervals, i = 0 .. intervals.
  type :: time_grid_type
    real(wp) :: start = 0.0_wp   !< [s]
    real(wp) :: end = 1.0_wp     !< [s]
    integer :: intervals = 100   !< equal intervals between outputs
  contains
    procedure :: time
  end type time_grid_type

  !> The settings of &solver.
  type :: solver_settings_type
    character(len=:), allocatable :: method       !< of integration; empty: the program's default
    real(wp) :: accuracy = 0.0_wp                 !< largest error at an output [rad, m]; 0: the tolerances decide
    real(wp) :: relative_tolerance = 1.0e-8_wp    !< of each coordinate and rate, in a step
    real(wp) :: absolute_tolerance = 1.0e-10_wp   !< of each coordinate and rate, in its unit
    integer :: maximum_steps = 1000000            !< between two outputs
  end type solver_settings_type

  !> The settings of &output. A file whose name is empty is not written.
  type :: output_settings_type
    character(len=:), allocatable :: table       !< name of the table's file
    character(len=:), allocatable :: hdf5        !< name of the HDF5 file
    character(len=:), allocatable :: sketch      !< name of the drawing's file
    character(len=:), allocatable :: animation   !< name of the film's file
    character(len=:), allocatable :: view        !< direction of view of both; empty: the best one
    logical :: poses = .false.                   !< the HDF5 file holds the poses of links
    logical :: hdf5_runs = .false.               !< the HDF5 file of a study holds the columns of all its runs
    integer :: compression = 0                   !< of the HDF5 file, from 0 (none) to 9 (most)
    logical :: conditioning = .false.            !< the least singular value has a column
    integer, allocatable :: coordinates(:)       !< coordinates that have columns; none listed: all
    integer :: derivatives = 2                   !< order of the highest derivative in time that is recorded
    logical :: energies = .true.                 !< the energies have columns
    logical :: reactions = .false.               !< the wrenches of pairs have columns
    integer, allocatable :: reaction_pairs(:)    !< coordinates of these pairs; none listed: all
    logical :: drive_forces = .false.            !< the forces of drives have columns
    logical :: sensitivities = .false.           !< the derivatives by all parameters have columns
    logical :: gradients = .false.               !< the quantities have derivatives by all parameters, whose columns are not recorded
    type(place_type) :: sensitivities_place      !< place of either request in the data file
    type(place_type) :: sketch_place, animation_place, view_place   !< of the names of pictures and of the view in the data file
    logical :: force_arrows = .false.            !< pictures show the forces in pairs as arrows
    logical :: velocity_arrows = .false.         !< pictures show the velocities of the points as arrows
    logical :: acceleration_arrows = .false.     !< pictures show their accelerations as arrows
    integer, allocatable :: links(:)             !< links whose turning motion has columns
    integer, allocatable :: poles(:)             !< links whose velocity poles have columns
    logical :: reaction_magnitudes = .false.     !< the magnitudes of the wrenches of pairs have columns
    logical :: reactions_in_links = .false.      !< the wrenches are along the axes of the moving links; else of link 1
  contains
    procedure :: recorded
    procedure :: reacting
    procedure :: with_forces
    procedure :: with_derivatives
    procedure :: drawn_forces
  end type output_settings_type

  !> A cam whose profile follows from the motion of its follower: it touches a roller, an edge or a flat face of the follower.
  type :: cam_request_type
    integer :: link = 0                    !< number of the cam's link
    integer :: follower = 0                !< number of the follower's link
    real(wp) :: point(3) = 0.0_wp          !< centre of the roller, or a point of the flat face, in the follower's system [m]
    real(wp) :: roller = 0.0_wp            !< radius of the roller; 0: an edge [m]
    logical :: flat = .false.              !< the follower has a flat face in place of a roller
    real(wp) :: face(3) = 0.0_wp           !< unit normal of the flat face towards the cam, in the follower's system
    logical :: outer = .false.             !< the cam surrounds the path of the roller
    real(wp) :: axis(3) = 0.0_wp           !< unit normal of the cam's plane, in the cam's system
    integer :: guide = 0                   !< coordinate of the pair that guides the follower; 0: none
    integer :: coordinate = 0              !< coordinate by which the cam turns or slides
    type(place_type) :: place              !< place of its group in the data file
  end type cam_request_type

  !> The results of a problem that the user wants.
  type :: request_type
    type(time_grid_type) :: time
    type(solver_settings_type) :: solver
    type(output_settings_type) :: output
    type(quantity_type), allocatable :: quantities(:)   !< in the order of the data file
    type(study_type) :: study
    type(objective_type), allocatable :: objectives(:)  !< in the order of the data file; for --optimize
    type(limit_type), allocatable :: limits(:)          !< in the order of the data file; for --optimize
    type(optimum_type) :: optimum
    type(cam_request_type), allocatable :: cams(:)   !< in the order of the data file
    type(section_type) :: section
    type(exponents_type) :: exponents
    type(periodic_type) :: periodic
    type(branch_request_type), allocatable :: branches(:)   !< in the order of the data file; for --branch
  end type request_type

contains

  !> Whether each coordinate is recorded: all are, unless some are listed.
  pure function recorded(self, n_coordinates)
    class(output_settings_type), intent(in) :: self   !< the output settings
    integer, intent(in) :: n_coordinates              !< M
    logical :: recorded(n_coordinates)

    recorded = .true.
    if (.not. allocated(self%coordinates)) return
    if (size(self%coordinates) == 0) return
    recorded = .false.
    recorded(self%coordinates) = .true.
  end function recorded

  !> Whether the wrench of each pair is recorded.
  pure function reacting(self, n_coordinates)
    class(output_settings_type), intent(in) :: self   !< the output settings
    integer, intent(in) :: n_coordinates              !< M
    logical :: reacting(n_coordinates)

    reacting = self%reactions
    if (.not. (self%reactions .and. allocated(self%reaction_pairs))) return
    if (size(self%reaction_pairs) == 0) return
    reacting = .false.
    reacting(self%reaction_pairs) = .true.
  end function reacting

  !> Whether forces are recorded or drawn, which depend on the motion of all links.
  pure logical function with_forces(self)
    class(output_settings_type), intent(in) :: self   !< the output settings

    with_forces = self%reactions .or. self%drive_forces .or. self%force_arrows
  end function with_forces

  !> Whether derivatives by the parameters are computed: as columns of the results, or of quantities alone.
  pure logical function with_derivatives(self)
    class(output_settings_type), intent(in) :: self   !< the output settings

    with_derivatives = self%sensitivities .or. self%gradients
  end function with_derivatives

  !> Whether the force in each pair is drawn.
  pure function drawn_forces(self, n_coordinates)
    class(output_settings_type), intent(in) :: self   !< the output settings
    integer, intent(in) :: n_coordinates              !< M
    logical :: drawn_forces(n_coordinates)

    drawn_forces = self%force_arrows
    if (self%force_arrows .and. self%reactions) drawn_forces = self%reacting(n_coordinates)
  end function drawn_forces

  !> Time of output i; the last one is exactly the end.
  pure real(wp) function time(self, i)
    class(time_grid_type), intent(in) :: self   !< the time grid
    integer, intent(in) :: i                    !< number of the output, 0 .. intervals

    if (i == self%intervals) then
      time = self%end
    else
      time = self%start + (self%end - self%start)*i/real(self%intervals, wp)
    end if
  end function time
end module mech9_request
