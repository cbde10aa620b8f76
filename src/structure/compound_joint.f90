!> Joints with several freedoms: chains of pairs with one freedom each, over inner links without numbers in the data file.
!>
!> Such a joint stands between two links of the user. Its pairs have coordinates with the user's numbers; the massless links
!> between the pairs have numbers above those of the user's links.
module mech9_compound_joint
  implicit none
  private
  public :: compound_joint_type, compound_kinds, is_compound, most_freedoms

  integer, parameter :: most_freedoms = 6
  character(len=*), parameter :: compound_kinds(5) = &
    [character(len=11) :: 'spherical', 'universal', 'cylindrical', 'planar', 'free']

  !> One joint.
  type :: compound_joint_type
    character(len=len(compound_kinds)) :: kind = ''   !< one of `compound_kinds`
    integer :: freedoms = 0                           !< number of its coordinates
    integer :: numbers(most_freedoms) = 0             !< of its coordinates, from the reference link to the moving link
    integer :: ends(2) = 0                            !< the reference link and the moving link
    integer :: before_inner = 0                       !< its inner links have the numbers above this one, in the order of the chain
  contains
    procedure :: coordinates
    procedure :: links_of_pair
  end type compound_joint_type

contains

  !> Whether a kind of pairs has several freedoms.
  pure logical function is_compound(kind)
    character(len=*), intent(in) :: kind   !< as in the data file, in lower case

    is_compound = any(compound_kinds == kind)
  end function is_compound

  !> The numbers of its coordinates.
  pure function coordinates(self)
    class(compound_joint_type), intent(in) :: self   !< the joint
    integer :: coordinates(self%freedoms)

    coordinates = self%numbers(:self%freedoms)
  end function coordinates

  !> The reference link and the moving link of one of its pairs.
  pure function links_of_pair(self, i) result(links)
    class(compound_joint_type), intent(in) :: self   !< the joint
    integer, intent(in) :: i                         !< place of the pair in the chain, from 1
    integer :: links(2)

    links = self%before_inner + [i - 1, i]
    if (i == 1) links(1) = self%ends(1)
    if (i == self%freedoms) links(2) = self%ends(2)
  end function links_of_pair
end module mech9_compound_joint
