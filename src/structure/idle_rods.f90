!> Rods between two ball joints: links that can turn about the line between both balls by themselves, whatever moves else.
module mech9_idle_rods
  use mech9_structure, only: structure_type
  implicit none
  private
  public :: idle_rod_type, find_idle_rods

  !> One rod.
  type :: idle_rod_type
    integer :: link = 0         !< number of the rod
    integer :: joints(2) = 0    !< numbers of its ball joints among those with several freedoms
  end type idle_rod_type

contains

  !> All links but the frame with two spherical joints and no other pair.
  pure subroutine find_idle_rods(structure, rods)
    type(structure_type), intent(in) :: structure            !< links and joints
    type(idle_rod_type), allocatable, intent(out) :: rods(:) !< in the order of their links
    integer, dimension(structure%n_links) :: pairs, balls
    integer :: joints(2, structure%n_links), found(structure%n_links), i, j, k, n, link

    pairs = 0
    balls = 0
    joints = 0
    do k = 1, structure%n_coordinates
      pairs(structure%links(:, k)) = pairs(structure%links(:, k)) + 1
    end do
    if (allocated(structure%joints)) then
      do j = 1, size(structure%joints)
        if (structure%joints(j)%kind /= 'spherical') cycle
        do i = 1, 2
          link = structure%joints(j)%ends(i)
          balls(link) = balls(link) + 1
          if (balls(link) <= 2) joints(balls(link), link) = j
        end do
      end do
    end if
    n = 0
    do link = 2, structure%n_links
      if (pairs(link) /= 2 .or. balls(link) /= 2) cycle
      n = n + 1
      found(n) = link
    end do
    allocate (rods(n))
    do i = 1, n
      rods(i)%link = found(i)
      rods(i)%joints = joints(:, found(i))
    end do
  end subroutine find_idle_rods
end module mech9_idle_rods
