!> One arrow in the pictures of a run: its meaning, its shape, and its vector in each frame.
module mech9_arrow
  use mech9_kinds, only: wp
  use mech9_film, only: film_type
  use mech9_scene, only: in_force
  implicit none
  private
  public :: arrow_type, append_arrow, remove_arrow, links_of, straight, double, ring, pole

  !> Shapes: an arrow with one head, one with two heads for a moment that is seen from the side, an arrow round its axis for a moment
  !> that is seen along it, and the mark of a velocity pole.
  integer, parameter :: straight = 1, double = 2, ring = 3, pole = 4

  !> One arrow.
  type :: arrow_type
    integer :: style = in_force               !< style of its kind
    integer :: shape = straight               !< straight, double, ring or pole
    integer :: measure = 0                    !< arrows of the same measure have one scale; 0: none
    character(len=:), allocatable :: text     !< meaning, such as velocity of P
    integer :: link = 1                       !< link where it begins
    real(wp) :: foot(3) = 0.0_wp              !< place in the link where it begins, or round which it runs [m]
    real(wp), allocatable :: feet(:, :)       !< (3,frames) place in link 1 where it begins, if it moves on its link [m]
    !> (3,frames) from its foot to its tip, in the axes of link 1; N, N m, m/s or m/s^2 at first, then m
    real(wp), allocatable :: ways(:, :)
  contains
    procedure :: greatest
    procedure :: begins_at
  end type arrow_type

contains

  !> The greatest length of its vector in the film.
  pure real(wp) function greatest(self)
    class(arrow_type), intent(in) :: self   !< the arrow
    integer :: frame

    greatest = 0.0_wp
    do frame = 1, size(self%ways, 2)
      greatest = max(greatest, norm2(self%ways(:, frame)))
    end do
  end function greatest

  !> The place where it begins in a frame of a film, in the system of link 1 [m].
  pure function begins_at(self, film, frame) result(place)
    class(arrow_type), intent(in) :: self   !< the arrow
    type(film_type), intent(in) :: film     !< poses at the outputs of the run
    integer, intent(in) :: frame            !< number of the frame
    real(wp) :: place(3)

    if (allocated(self%feet)) then
      place = self%feet(:, frame)
    else
      place = film%position(frame, self%link, self%foot)
    end if
  end function begins_at

  !> The number of links that a film gets for an arrow: they hold its tip and its barbs, or the whole ring, and at last a foot that moves on
  !> its link.
  pure elemental integer function links_of(arrow)
    type(arrow_type), intent(in) :: arrow   !< the arrow

    links_of = 1
    if (arrow%shape == straight) links_of = 3
    if (arrow%shape == double) links_of = 6
    if (allocated(arrow%feet)) links_of = links_of + 1
  end function links_of

  !> Append an arrow to a list.
  subroutine append_arrow(arrow, arrows)
    type(arrow_type), intent(in) :: arrow                        !< the arrow
    type(arrow_type), allocatable, intent(inout) :: arrows(:)    !< gets it as the last one
    type(arrow_type), allocatable :: longer(:)
    integer :: n

    n = size(arrows)
    allocate (longer(n + 1))
    longer(:n) = arrows
    longer(n + 1) = arrow
    call move_alloc(longer, arrows)
  end subroutine append_arrow

  !> Remove an arrow from a list.
  subroutine remove_arrow(number, arrows)
    integer, intent(in) :: number                                !< of the arrow
    type(arrow_type), allocatable, intent(inout) :: arrows(:)    !< loses it
    type(arrow_type), allocatable :: shorter(:)

    allocate (shorter(size(arrows) - 1))
    shorter(:number - 1) = arrows(:number - 1)
    shorter(number:) = arrows(number + 1:)
    call move_alloc(shorter, arrows)
  end subroutine remove_arrow
end module mech9_arrow
