!> mech9k: kinematics of mechanisms from structural data.
program mech9k
  use mech9_mech9k_session, only: mech9k_main
  implicit none

  call mech9k_main()
end program mech9k
