!> The explanation of one name of the data file.
module mech9_name_explanation
  implicit none
  private
  public :: explanation_type

  !> The explanation of one name.
  type :: explanation_type
    character(len=10) :: group
    character(len=20) :: name
    character(len=56) :: kinds                 !< kinds as in the grammar, which tell rows of one name apart
    character(len=275) :: text                 !< whole sentences
    character(len=84) :: example               !< a value as it is typed, for angles in rad, and its meaning in parentheses
    character(len=84) :: degrees = ''          !< the same for an angle in degrees; empty: as in rad
    character(len=84) :: length = ''           !< the same for a coordinate that is a length; empty: as for an angle
  end type explanation_type
end module mech9_name_explanation
