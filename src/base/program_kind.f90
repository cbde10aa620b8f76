!> The two programs, which differ in what determines a motion.
module mech9_program_kind
  implicit none
  private
  public :: kinematics, dynamics, both_programs, program_names, belongs_to

  integer, parameter :: kinematics = 1   !< drives determine the motion of all independent coordinates: mech9k
  integer, parameter :: dynamics = 2     !< masses and forces determine that of coordinates without drives: mech9d
  integer, parameter :: both_programs = 0   !< of an option, a group or a name that both programs have

  character(len=6), parameter :: program_names(2) = ['mech9k', 'mech9d']

contains

  !> Whether a program has what belongs to one program or to both.
  elemental logical function belongs_to(owner, program)
    integer, intent(in) :: owner     !< kinematics, dynamics or both_programs
    integer, intent(in) :: program   !< kinematics or dynamics

    belongs_to = owner == both_programs .or. owner == program
  end function belongs_to
end module mech9_program_kind
