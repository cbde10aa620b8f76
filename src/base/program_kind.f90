!> The two programs, which differ in what determines a motion.
module mech9_program_kind
  implicit none
  private
  public :: kinematics, dynamics, program_names

  integer, parameter :: kinematics = 1   !< drives determine the motion of all independent coordinates: mech9k
  integer, parameter :: dynamics = 2     !< masses and forces determine that of coordinates without drives: mech9d

  character(len=6), parameter :: program_names(2) = ['mech9k', 'mech9d']
end module mech9_program_kind
