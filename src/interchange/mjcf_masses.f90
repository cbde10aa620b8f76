!> Masses of links in MJCF: told by <inertial>, or made of the shapes of the link.
module mech9_mjcf_masses
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_rotation, only: identity
  use mech9_pose, only: pose_type, compose
  use mech9_inertia, only: inertia_in_axes
  use mech9_xml_tree, only: xml_tree_type
  use mech9_xml_values, only: get_numbers, get_number, get_list, place_in
  use mech9_robot, only: robot_type, robot_link_type
  use mech9_orientations, only: orientation_from_z
  use mech9_mjcf_settings, only: mjcf_settings_type
  use mech9_shapes, only: solid_of, shape_names
  implicit none
  private
  public :: mjcf_around_type, read_inertial, add_geom

  !> The surroundings of an element of a body.
  type :: mjcf_around_type
    integer :: class = 0             !< number of the element of the class of defaults that holds in them; 0: the main class
    type(pose_type) :: frame         !< of the element around it, in the frame of the link
    integer :: link = 1              !< number of the link; 1: the world
    logical :: from_geoms = .false.  !< shapes give the inertia of the link
  end type mjcf_around_type

  !> A solid shape.
  type :: shape_type
    integer :: kind = 0                         !< place among the names of shapes
    real(wp) :: size(3) = 0.0_wp                !< measures of the shape [m]
    type(pose_type) :: pose                     !< in the frame of the element around it
  end type shape_type

contains

  !> Read an element <inertial> of a link.
  subroutine read_inertial(tree, element, settings, link, err)
    type(xml_tree_type), intent(in) :: tree              !< the document
    integer, intent(in) :: element                       !< number of the element
    type(mjcf_settings_type), intent(in) :: settings     !< units and defaults
    type(robot_link_type), intent(inout) :: link         !< gets mass, mass centre and inertia
    type(error_type), allocatable, intent(inout) :: err  !< the failure
    type(pose_type) :: pose
    real(wp) :: diagonal(3), full(6)

    call settings%get_pose(tree, element, 0, pose, err)
    diagonal = 0.0_wp
    call get_numbers(tree, element, 'diaginertia', diagonal, err)
    full = [diagonal, 0.0_wp, 0.0_wp, 0.0_wp]
    call get_numbers(tree, element, 'fullinertia', full, err)
    call get_number(tree, element, 'mass', link%mass, err)
    if (link%mass < 0.0_wp) call tree%fail(element, "the mass of link '"//link%name//"' is negative", err)
    link%centre = pose%p
    link%inertia = inertia_in_axes(pose%r, reshape([full(1), full(4), full(5), full(4), full(2), full(6), &
                                                    full(5), full(6), full(3)], [3, 3]))
  end subroutine read_inertial

  !> Add the mass of an element <geom> to its link.
  subroutine add_geom(tree, element, settings, around, robot, err)
    type(xml_tree_type), intent(in) :: tree              !< the document
    integer, intent(in) :: element                       !< number of the element
    type(mjcf_settings_type), intent(in) :: settings     !< units and defaults
    type(mjcf_around_type), intent(in) :: around         !< its link and frame, with its own class of defaults
    type(robot_type), intent(inout) :: robot             !< its link gets the mass; gets notes
    type(error_type), allocatable, intent(inout) :: err  !< the failure
    character(len=:), allocatable :: word
    type(shape_type) :: shape
    type(pose_type) :: pose
    real(wp) :: volume, moments(3), mass, density

    if (allocated(err)) return
    word = tree%attribute(settings%holder(tree, element, around%class, 'type'), 'type')
    if (word == '') word = 'sphere'
    if (tree%has(settings%holder(tree, element, around%class, 'mesh'), 'mesh') .and. word == 'sphere') word = 'mesh'
    shape%kind = place_in(shape_names, word)
    density = 1000.0_wp
    call get_number(tree, settings%holder(tree, element, around%class, 'density'), 'density', density, err)
    mass = -1.0_wp
    call get_number(tree, settings%holder(tree, element, around%class, 'mass'), 'mass', mass, err)
    if (abs(mass) <= 0.0_wp .or. (mass < 0.0_wp .and. .not. density > 0.0_wp)) return
    if (any(word == [character(len=6) :: 'plane', 'hfield'])) return
    if (shape%kind == 0) then
      call robot%note(tree, element, 'the mass of shapes of the type '//word)
      return
    end if
    if (tree%attribute(element, 'shellinertia') == 'true') call robot%note(tree, element, 'shellinertia; the shape counts as solid')
    call read_placement(tree, element, settings, around%class, shape, err)
    if (allocated(err)) return
    call solid_of(shape%kind, shape%size, volume, moments)
    if (mass < 0.0_wp) mass = density*volume
    pose = compose(around%frame, shape%pose)
    call add_mass(robot%links(around%link), mass, pose%p, inertia_in_axes(pose%r, diagonal_of(mass*moments)))
  end subroutine add_geom

  !> Pose and size of a shape.
  subroutine read_placement(tree, element, settings, class, shape, err)
    type(xml_tree_type), intent(in) :: tree              !< the document
    integer, intent(in) :: element                       !< number of the element
    type(mjcf_settings_type), intent(in) :: settings     !< units and defaults
    integer, intent(in) :: class                         !< number of the element of its class of defaults
    type(shape_type), intent(inout) :: shape             !< with its kind; gets pose and size
    type(error_type), allocatable, intent(inout) :: err  !< the failure
    real(wp), allocatable :: list(:)
    real(wp) :: ends(6)
    integer :: from_to, n

    call settings%get_pose(tree, element, class, shape%pose, err)
    call get_list(tree, settings%holder(tree, element, class, 'size'), 'size', list, err)
    n = min(3, size(list))
    shape%size(:n) = list(:n)
    from_to = settings%holder(tree, element, class, 'fromto')
    if (from_to > 0 .and. shape_names(shape%kind) /= 'sphere') then
      ends = 0.0_wp
      call get_numbers(tree, from_to, 'fromto', ends, err)
      shape%pose%p = 0.5_wp*(ends(:3) + ends(4:))
      if (any(abs(ends(:3) - ends(4:)) > 0.0_wp)) shape%pose%r = orientation_from_z(ends(:3) - ends(4:))
      if (any(shape_names(shape%kind) == [character(len=9) :: 'capsule', 'cylinder'])) then
        shape%size(2) = 0.5_wp*norm2(ends(:3) - ends(4:))
      else
        ! MuJoCo takes the first number for both directions across
        shape%size(2) = shape%size(1)
        shape%size(3) = 0.5_wp*norm2(ends(:3) - ends(4:))
      end if
    end if
    if (any(shape%size < 0.0_wp) .or. .not. shape%size(1) > 0.0_wp) call tree%fail(element, "'size' must hold numbers above 0", err)
  end subroutine read_placement

  !> A tensor with these moments.
  pure function diagonal_of(moments) result(tensor)
    real(wp), intent(in) :: moments(3)  !< about x, y, z [kg m^2]
    real(wp) :: tensor(3, 3)
    integer :: i

    tensor = 0.0_wp
    do i = 1, 3
      tensor(i, i) = moments(i)
    end do
  end function diagonal_of

  !> Add a mass to a link: the mass centre moves, and both tensors are taken about the new one.
  pure subroutine add_mass(link, mass, centre, inertia)
    type(robot_link_type), intent(inout) :: link  !< the link
    real(wp), intent(in) :: mass                  !< [kg]
    real(wp), intent(in) :: centre(3)             !< its mass centre, in the frame of the link [m]
    real(wp), intent(in) :: inertia(3, 3)         !< about its own mass centre, in the axes of the link [kg m^2]
    real(wp) :: d(3), reduced
    integer :: k

    if (.not. link%mass + mass > 0.0_wp) return
    d = centre - link%centre
    reduced = link%mass*mass/(link%mass + mass)
    link%inertia = link%inertia + inertia
    do k = 1, 3
      link%inertia(:, k) = link%inertia(:, k) + reduced*(dot_product(d, d)*identity(:, k) - d*d(k))
    end do
    link%centre = link%centre + d*mass/(link%mass + mass)
    link%mass = link%mass + mass
  end subroutine add_mass
end module mech9_mjcf_masses
