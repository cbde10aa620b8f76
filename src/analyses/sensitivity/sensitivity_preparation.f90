!> Preparation of derivatives of a motion by parameters: what is decided once for all positions.
submodule (mech9_sensitivity) mech9_sensitivity_preparation
  use mech9_pose, only: transformed
  use mech9_plan, only: new_state
  use mech9_arithmetics, only: set_in_space
  use mech9_frame_variation, only: new_third_derivatives
  use mech9_twists, only: new_frame_twists
  use mech9_planar_batch, only: new_planar_batch
  use mech9_spatial_batch, only: new_spatial_batch
  use mech9_parameter_support, only: point_form, keep_static
  use mech9_planar_support, only: put_in_plane
  use mech9_varied_block, only: new_varied_block
  implicit none

contains

  module procedure prepare
    call choose_arithmetic(model, plan, self)
    call make_forms(model, self)
    call list_frames(model, self)
  end procedure prepare

  !> Choose planar arithmetic where neither the mechanism nor a parameter leaves the plane, and decide who places the frames.
  subroutine choose_arithmetic(model, plan, self)
    type(model_type), intent(in) :: model           !< the present model
    type(plan_type), intent(in) :: plan             !< its plan
    type(sensitivity_type), intent(inout) :: self   !< with the support; gets the plan and its arithmetic

    allocate (self%plan, source=plan)
    if (plan%planar%used .and. .not. any(self%support%constants%by_pair)) &
      call put_in_plane(plan, model%problem%initial%position, self%support, self%in_plane)
    if (self%in_plane) then
      self%places_frames = self%highest > 0 .and. any(plan%blocks%last_moved < plan%blocks%last_step)
      self%plane = new_planar_batch(plan%n_coordinates)
    else
      self%places_frames = plan%planar%used .or. self%highest > 0 .and. any(plan%blocks%last_moved < plan%blocks%last_step)
      if (allocated(plan%planar%planes)) self%places_frames = self%places_frames .or. any(plan%planar%plane_of > 0 .and. &
                                                                                          .not. plan%planar%shown)
      self%plan%blocks%arithmetic = 1
      self%plan%blocks%is_shown = .false.
      call set_in_space(self%plan)
      self%motion = new_frame_twists(plan%n_coordinates)
      self%third = new_third_derivatives(plan)
      self%space = new_spatial_batch(plan%n_coordinates)
    end if
    if (self%places_frames) allocate (self%state, source=new_state(self%plan))
    self%constants%list = self%support%constants(:self%support%count)
    allocate (self%constants%series(batch_size, merge(3, 6, self%in_plane), 0:2, self%support%count), source=0.0_wp)
  end subroutine choose_arithmetic

  !> Make the forms of chains and points, and decide how many positions are treated at once.
  subroutine make_forms(model, self)
    type(model_type), intent(in) :: model           !< the present model
    type(sensitivity_type), intent(inout) :: self   !< with support and plan; gets forms and lists
    logical :: varies(size(self%plan%blocks))
    integer, allocatable :: varied(:)
    integer :: b, i, p

    do b = 1, size(varies)
      associate (coordinates => self%plan%blocks(b)%coordinates)
        varies(b) = size(coordinates) > 0 .and. any(self%support%touched(coordinates, :))
      end associate
    end do
    varied = pack([(b, b=1, size(varies))], varies)
    allocate (self%blocks(size(varied)), self%drives(0), self%points_shift(size(model%mechanism%points)))
    allocate (self%apart(self%support%count), source=.false.)
    self%apart = self%support%constants(:self%support%count)%by_pair .or. &
                 self%support%constants(:self%support%count)%stretched_by > 0
    self%at_once = batch_size
    do b = 1, size(varied)
      self%blocks(b) = new_varied_block(self%plan, self%support, self%tangents, varied(b), self%in_plane, self%highest)
      self%at_once = min(self%at_once, self%blocks(b)%at_once)
      if (self%in_plane) cycle
      do i = 1, size(self%blocks(b)%forms)
        if (self%blocks(b)%forms(i)%rows < 6) self%apart(self%blocks(b)%forms(i)%constants) = .true.
      end do
    end do
    do p = 1, size(self%tangents)
      do i = 1, size(model%problem%drives)
        if (self%tangents(p)%drives(i)%varies) self%drives = [self%drives, varied_drive_type(p, i)]
      end do
    end do
    allocate (self%places(size(model%mechanism%points)))
    do i = 1, size(model%mechanism%points)
      call make_point(model, i, self)
    end do
  end subroutine make_forms

  !> Make the form of a point. The part of its shift that is normal to a plane never changes.
  subroutine make_point(model, number, self)
    type(model_type), intent(in) :: model           !< the present model
    integer, intent(in) :: number                   !< of the point
    type(sensitivity_type), intent(inout) :: self   !< with support and plan; gets the form
    integer :: rows, i

    rows = 3
    if (self%in_plane .and. self%plan%planar%in_xy_plane) rows = 2
    associate (point => model%mechanism%points(number), form => self%points_shift(number), planar => self%plan%planar)
      form = point_form(self%plan, self%support, number, self%plan%frame_of(point%link), rows)
      call keep_static(self%support, merge(1, 3, self%in_plane), .false., form)
      self%places(number)%frame = self%plan%frame_of(point%link)
      if (.not. self%in_plane) then
        self%places(number)%place = transformed(self%plan%link_in_frame(point%link), point%position)
        return
      end if
      self%places(number)%place = transformed(planar%link_in_frame(point%link), point%position)
      ! beside a plane of the first two axes, the third row of the shift never changes
      do i = 1, self%support%count
        associate (constant => self%support%constants(i))
          if (constant%point == number) &
            self%changes%values(:, place_of_point(self%plan%n_coordinates, number, 0, 3), constant%parameter) = constant%twist(4)
        end associate
      end do
    end associate
  end subroutine make_point

  !> List the frames and steps whose motion is needed, and decide whether some of it is found at each position by itself.
  subroutine list_frames(model, self)
    type(model_type), intent(in) :: model           !< the present model
    type(sensitivity_type), intent(inout) :: self   !< with its forms; gets the lists
    logical, dimension(self%plan%n_coordinates) :: touched
    logical, dimension(0:self%plan%n_coordinates) :: parents, turned, taken
    integer :: b, i

    touched = any(self%support%touched(self%plan%steps%coordinate, :), dim=2)
    self%steps = pack([(i, i=1, size(touched))], touched)
    parents = .false.
    parents(self%plan%steps(self%steps)%parent) = .true.
    turned = .false.
    turned(self%support%constants(:self%support%count)%frame) = .true.
    taken = .false.
    do i = 1, size(model%mechanism%points)
      associate (frame => self%plan%frame_of(model%mechanism%points(i)%link))
        taken(frame) = .true.
        if (.not. self%in_plane) turned(frame) = .true.
      end associate
    end do
    do b = 1, size(self%blocks)
      do i = self%plan%blocks(self%blocks(b)%number)%first_closure, self%plan%blocks(self%blocks(b)%number)%last_closure
        if (self%in_plane) then
          taken(self%plan%planar%closures(i)%base) = .true.
        else if (self%plan%closures(i)%coupling == 0) then
          taken(self%plan%closures(i)%closing) = .true.
        end if
      end do
    end do
    taken = taken .or. turned
    allocate (self%slides(0))
    if (self%in_plane) then
      taken(self%steps) = .true.
      self%slides = pack(self%steps, .not. self%plan%planar%steps(self%steps)%turns)
    end if
    taken = taken .or. parents
    self%parents = pack([(i, i=0, size(touched))], parents .or. turned)
    self%screws = pack(self%steps, self%plan%steps(self%steps)%is_screw)
    self%others = pack(self%steps, .not. self%plan%steps(self%steps)%is_screw)
    if (.not. self%in_plane) taken(self%screws) = .true.
    self%turned = pack([(i, i=1, size(touched))], turned(1:))
    self%frames = pack([(i, i=1, size(touched))], taken(1:))
    if (self%in_plane) return
    self%by_position = any(self%apart) .or. size(self%others) > 0
    do b = 1, size(self%blocks)
      self%by_position = self%by_position .or. any(self%blocks(b)%forms%rows < 6)
    end do
  end subroutine list_frames
end submodule mech9_sensitivity_preparation
