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
  public :: read_inertial, add_geom

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

  !> Add the mass of an element <geom> to a link.
  subroutine add_geom(tree, element, settings, class, frame, robot, link, err)
    type(xml_tree_type), intent(in) :: tree              !< the document
    integer, intent(in) :: element                       !< number of the element
    type(mjcf_settings_type), intent(in) :: settings     !< units and defaults
    integer, intent(in) :: class                         !< number of the element of its class of defaults
    type(pose_type), intent(in) :: frame                 !< of the element around it, in the frame of the link
    type(robot_type), intent(inout) :: robot             !< gets notes
    type(robot_link_type), intent(inout) :: link         !< gets the mass
    type(error_type), allocatable, intent(inout) :: err  !< the failure
    character(len=:), allocatable :: word
    type(pose_type) :: pose
    real(wp) :: size(3), volume, moments(3), mass, density
    integer :: shape

    if (allocated(err)) return
    word = tree%attribute(settings%holder(tree, element, class, 'type'), 'type')
    if (word == '') word = 'sphere'
    if (tree%has(settings%holder(tree, element, class, 'mesh'), 'mesh') .and. word == 'sphere') word = 'mesh'
    shape = place_in(shape_names, word)
    density = 1000.0_wp
    call get_number(tree, settings%holder(tree, element, class, 'density'), 'density', density, err)
    mass = -1.0_wp
    call get_number(tree, settings%holder(tree, element, class, 'mass'), 'mass', mass, err)
    if (abs(mass) <= 0.0_wp .or. (mass < 0.0_wp .and. .not. density > 0.0_wp)) return
    if (any(word == [character(len=6) :: 'plane', 'hfield'])) return
    if (shape == 0) then
      call robot%note(tree, element, 'the mass of shapes of the type '//word)
      return
    end if
    if (tree%attribute(element, 'shellinertia') == 'true') call robot%note(tree, element, 'shellinertia; the shape counts as solid')
    call read_placement(tree, element, settings, class, shape, pose, size, err)
    if (allocated(err)) return
    call solid_of(shape, size, volume, moments)
    if (mass < 0.0_wp) mass = density*volume
    pose = compose(frame, pose)
    call add_mass(link, mass, pose%p, inertia_in_axes(pose%r, diagonal_of(mass*moments)))
  end subroutine add_geom

  !> Pose and size of a shape.
  subroutine read_placement(tree, element, settings, class, shape, pose, size, err)
    type(xml_tree_type), intent(in) :: tree              !< the document
    integer, intent(in) :: element                       !< number of the element
    type(mjcf_settings_type), intent(in) :: settings     !< units and defaults
    integer, intent(in) :: class                         !< number of the element of its class of defaults
    integer, intent(in) :: shape                         !< place among the names of shapes
    type(pose_type), intent(out) :: pose                 !< in the frame of the element around it
    real(wp), intent(out) :: size(3)                     !< measures of the shape [m]
    type(error_type), allocatable, intent(inout) :: err  !< the failure
    real(wp), allocatable :: list(:)
    real(wp) :: ends(6)
    integer :: from_to, n

    call settings%get_pose(tree, element, class, pose, err)
    call get_list(tree, settings%holder(tree, element, class, 'size'), 'size', list, err)
    size = 0.0_wp
    n = min(3, ubound(list, 1))
    size(:n) = list(:n)
    from_to = settings%holder(tree, element, class, 'fromto')
    if (from_to > 0 .and. shape_names(shape) /= 'sphere') then
      ends = 0.0_wp
      call get_numbers(tree, from_to, 'fromto', ends, err)
      pose%p = 0.5_wp*(ends(:3) + ends(4:))
      if (any(abs(ends(:3) - ends(4:)) > 0.0_wp)) pose%r = orientation_from_z(ends(:3) - ends(4:))
      if (any(shape_names(shape) == [character(len=9) :: 'capsule', 'cylinder'])) then
        size(2) = 0.5_wp*norm2(ends(:3) - ends(4:))
      else
        ! MuJoCo takes the first number for both directions across
        size(2) = size(1)
        size(3) = 0.5_wp*norm2(ends(:3) - ends(4:))
      end if
    end if
    if (any(size < 0.0_wp) .or. .not. size(1) > 0.0_wp) call tree%fail(element, "'size' must hold numbers above 0", err)
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
