!> The planar designs of a synthesis: whether all designs move in one plane, their numbers in planar arithmetic, found from their
!> plans, and their drives.
module mech9_planar_design
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_pose, only: transformed
  use mech9_planar_numbers, only: planar_design_type, numbers_of_point, place_numbers
  use mech9_design_space, only: design_space_type, design_type, new_design, copy_design, place_design, place_drives, probe, probes
  implicit none
  private
  public :: judge_plane, new_planar_design, place_planar_design

  !> Numbers are affine where they differ by no more than this part of the largest one from an affine function.
  real(wp), parameter :: affine = 1.0e-12_wp

contains

  !> Find out whether parameters move a planar mechanism out of its plane: all designs then move in space.
  subroutine judge_plane(space)
    type(design_space_type), intent(inout) :: space   !< gets `in_plane`
    type(design_type) :: design
    type(error_type), allocatable :: err
    real(wp) :: x(size(space%varied))
    integer :: i

    ! designs that leave the plane at all leave it everywhere but on a set without volume
    if (.not. space%in_plane) return
    call new_design(space, design)
    do i = 1, 2*size(x) + probes
      if (i <= 2*size(x)) then
        x = space%values(space%varied)
        x((i + 1)/2) = merge(space%low((i + 1)/2), space%high((i + 1)/2), mod(i, 2) == 1)
      else
        x = probe(space, i - 2*size(x))
      end if
      call place_design(space, x, design, err)
      if (.not. allocated(err)) cycle
      ! a place without a model decides nothing
      if (design%plan%planar%used) cycle
      space%in_plane = .false.
      return
    end do
  end subroutine judge_plane

  !> Prepare the numbers of designs; `used` is false where they are not planar or not affine.
  subroutine new_planar_design(space, design, planar)
    type(design_space_type), intent(inout) :: space       !< the designs
    type(design_type), intent(in) :: design               !< any of them
    type(planar_design_type), intent(out) :: planar       !< the numbers
    type(design_type) :: other
    real(wp) :: x(size(space%varied)), largest
    real(wp), allocatable :: low(:), high(:), rigid(:), first(:)
    integer :: i
    logical :: done

    if (.not. (design%plan%planar%used .and. space%is_affine)) return
    call copy_design(design, other)
    planar%at = space%values(space%varied)
    call numbers_at(space, planar%at, other, planar%base, first, done)
    if (.not. done) return
    planar%steps = other%plan%planar%steps
    planar%closures = other%plan%planar%closures
    allocate (planar%points(numbers_of_point, size(design%places, 2)))
    allocate (planar%slopes(size(planar%base), size(x)))
    do i = 1, size(x)
      x = planar%at
      x(i) = space%high(i)
      call numbers_at(space, x, other, high, rigid, done)
      if (done) done = all(abs(rigid - first) <= affine)
      if (.not. done) return
      x(i) = space%low(i)
      call numbers_at(space, x, other, low, rigid, done)
      if (done) done = all(abs(rigid - first) <= affine)
      if (.not. done) return
      planar%slopes(:, i) = (high - low)/(space%high(i) - space%low(i))
    end do
    ! the farthest corner serves as a test
    call numbers_at(space, space%high, other, high, rigid, done)
    if (.not. done) return
    low = planar%base + matmul(planar%slopes, space%high - planar%at)
    largest = max(maxval(abs(high)), maxval(abs(low)))
    where (abs(planar%slopes)*spread(space%high - space%low, 1, size(planar%base)) <= affine*largest) planar%slopes = 0.0_wp
    planar%used = all(abs(high - low) <= affine*largest)
    planar%moves_drives = space%moves_drives()
    planar%numbers = planar%base
  end subroutine new_planar_design

  !> The numbers of a design, and those that must not change: directions of slides, and cosines and sines of closures.
  subroutine numbers_at(space, x, design, numbers, rigid, done)
    type(design_space_type), intent(inout) :: space         !< the designs
    real(wp), intent(in) :: x(:)                            !< (varied) values of the parameters
    type(design_type), intent(inout) :: design              !< gets the design
    real(wp), allocatable, intent(out) :: numbers(:)        !< the numbers [m, rad]
    real(wp), allocatable, intent(out) :: rigid(:)          !< numbers without a unit
    logical, intent(out) :: done                            !< the design exists
    type(error_type), allocatable :: err
    integer :: i

    call place_design(space, x, design, err)
    done = .not. allocated(err)
    if (.not. done) return
    associate (flat => design%plan%planar, points => space%model%mechanism%points)
      done = flat%used
      if (.not. done) return
      numbers = [(flat%steps(i)%place, flat%steps(i)%angle, i=1, size(flat%steps)), &
                 (flat%closures(i)%place, i=1, size(flat%closures)), &
                 (transformed(flat%link_in_frame(points(i)%link), design%places(:, i)), i=1, size(points))]
      rigid = [(flat%steps(i)%slide, i=1, size(flat%steps)), &
               (flat%closures(i)%cosine, flat%closures(i)%sine, i=1, size(flat%closures))]
    end associate
  end subroutine numbers_at

  !> Give a design the values of its parameters: its planar numbers, and its drives.
  pure subroutine place_planar_design(space, x, planar, design)
    type(design_space_type), intent(in) :: space             !< the designs
    real(wp), intent(in) :: x(:)                             !< (varied) values of the parameters
    type(planar_design_type), intent(inout) :: planar        !< gets the numbers
    type(design_type), intent(inout) :: design               !< gets the values and its drives; its plans stay as they are

    design%x = x
    call place_numbers(x, planar)
    if (planar%moves_drives) call place_drives(space, x, design)
  end subroutine place_planar_design
end module mech9_planar_design
