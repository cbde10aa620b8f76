!> The rows of the table that describes the language of the data file.
module mech9_grammar_rows
  use mech9_program_kind, only: both_programs
  implicit none
  private
  public :: group_row_type, item_row_type, unlimited, for_forces, needed, optional, any_law, variable_of_law
  public :: refers_to, refers_to_link, refers_to_coordinate

  !> One kind of group.
  type :: group_row_type
    character(len=10) :: name
    logical :: repeats           !< may stand more than once
    character(len=11) :: key     !< the name whose value tells its groups apart; empty: none does
    !> Program that uses it: kinematics, dynamics, both_programs, or for_forces: dynamics, and kinematics where forces are asked for.
    integer :: program
    character(len=120) :: help
  end type group_row_type

  !> One name of a group. Several rows may share a name where its meaning depends on the kind.
  type :: item_row_type
    character(len=10) :: group
    character(len=20) :: name
    character(len=8) :: type  !< integer, real, text or logical
    integer :: low            !< fewest values
    integer :: high           !< most values; more than one makes a list
    !> Empty for pure numbers. `angle` is rad or degrees, as angle_unit says, `angle/s` the rate_unit; `q` is the unit of
    !> the coordinate: an angle, a length, or that of a user's pair. m, N and kg are the units that &mechanism names.
    character(len=13) :: unit
    logical :: needed             !< must be given wherever its kind allows it
    character(len=22) :: default  !< the default as it would be written; in parentheses where it is a rule
    character(len=10) :: range    !< the range of values: empty, >0, >=0, >=1, or >0 and <1
    character(len=108) :: words   !< the texts allowed, with blanks between; empty: any
    character(len=72) :: kinds    !< the kinds of the group it belongs to, or the laws of time, as in law:harmonic; empty: all
    character(len=120) :: help
    character(len=44) :: example  !< a value as it would be written
    logical :: seldom = .false.   !< the conversation asks for it only on request
    integer :: program = both_programs   !< program that uses it; the conversation of the other one does not ask for it
  end type item_row_type

  integer, parameter :: unlimited = huge(1)
  integer, parameter :: for_forces = 3
  logical, parameter :: needed = .true., optional = .false.

  !> The numbers under a name are those of links, or of coordinates: names may stand in their places.
  integer, parameter :: refers_to_link = 1, refers_to_coordinate = 2

  !> Names that belong to all laws but a constant, and the meaning of that of their variable.
  character(len=*), parameter :: any_law = 'law:polynomial law:harmonic law:table law:segments'
  character(len=*), parameter :: variable_of_law = 'variable of the law in place of t: a coordinate, a rate (dq1) or a point '// &
    '(P.x, P.vx), in units of this file'

contains

  !> Whether the whole numbers under a name are those of links (refers_to_link) or of coordinates (refers_to_coordinate); 0: neither.
  pure integer function refers_to(group, name) result(kind)
    character(len=*), intent(in) :: group   !< name of the group, in lower case
    character(len=*), intent(in) :: name    !< name of the item, in lower case

    kind = 0
    if (group == 'mechanism' .or. group == 'link') return
    select case (name)
    case ('link', 'links', 'poles', 'follower', 'nrg')
      kind = refers_to_link
    case ('coordinate', 'coordinates', 'guide', 'reaction_pairs', 'cq', 'nws')
      if (group /= 'pair') kind = refers_to_coordinate
    end select
  end function refers_to
end module mech9_grammar_rows
