!> Names of links and pairs for people. Nobody knows the links that belong to a joint with several freedoms: they are called by
!> the name of the joint.
module mech9_joint_words
  use mech9_text, only: to_text
  use mech9_compound_joint, only: compound_joint_type
  use mech9_structure, only: structure_type
  implicit none
  private
  public :: pair_name, link_name, joint_name, shown_of

  integer, parameter :: longest_name = 100

contains

  !> "spherical joint of coordinates 4, 5, 6".
  pure function joint_name(joint) result(name)
    type(compound_joint_type), intent(in) :: joint   !< the joint
    character(len=longest_name) :: name

    name = trim(joint%kind)//' joint of coordinates '//to_text(joint%coordinates())
  end function joint_name

  !> "pair 4", or "the spherical joint of coordinates 4, 5, 6 between links 2 and 3".
  pure function pair_name(structure, coordinate) result(name)
    type(structure_type), intent(in) :: structure   !< the structure
    integer, intent(in) :: coordinate               !< number of the coordinate
    character(len=longest_name + 40) :: name

    name = name_in(structure, structure%joint_of(coordinate), 'pair '//to_text(coordinate))
  end function pair_name

  !> "link 4", or the name of the joint to which the link belongs.
  pure function link_name(structure, link) result(name)
    type(structure_type), intent(in) :: structure   !< the structure
    integer, intent(in) :: link                     !< number of the link
    character(len=longest_name + 40) :: name

    name = name_in(structure, structure%joint_of_link(link), 'link '//to_text(link))
  end function link_name

  !> The name of a part of a joint: "the spherical joint of coordinates 4, 5, 6 between links 2 and 3"; its own outside of joints.
  pure function name_in(structure, number, own) result(name)
    type(structure_type), intent(in) :: structure   !< the structure
    integer, intent(in) :: number                   !< number of the joint; 0: none
    character(len=*), intent(in) :: own             !< name of the part where it belongs to no joint
    character(len=longest_name + 40) :: name

    name = own
    if (number == 0) return
    associate (joint => structure%joints(number))
      name = 'the '//trim(joint_name(joint))//' between links '//to_text(joint%ends(1))//' and '//to_text(joint%ends(2))
    end associate
  end function name_in

  !> Those of some links that the user knows.
  pure function shown_of(structure, links) result(shown)
    type(structure_type), intent(in) :: structure   !< the structure
    integer, intent(in) :: links(:)                 !< numbers of links
    integer, allocatable :: shown(:)

    shown = pack(links, links <= structure%shown_links())
  end function shown_of
end module mech9_joint_words
