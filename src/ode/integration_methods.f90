!> The methods of integration by name.
module mech9_integration_methods
  use mech9_kinds, only: wp
  implicit none
  private
  public :: integration_method_type, integration_methods, method_index, step_tolerance_type, tolerance_for, least_tolerance
  public :: runge_kutta, multistep, automatic
  public :: no_table, prince_dormand_table, dormand_prince_table, verner_table, fehlberg_table, kutta_merson_table

  !> Families of methods.
  integer, parameter :: runge_kutta = 1   !< explicit, one step
  integer, parameter :: multistep = 2     !< of variable order
  integer, parameter :: automatic = 3     !< several methods by turns

  !> Coefficients of the Runge-Kutta methods. SUNDIALS brings three of these tables, mech9_butcher_tables the others.
  integer, parameter :: no_table = 0
  integer, parameter :: prince_dormand_table = 1
  integer, parameter :: dormand_prince_table = 2
  integer, parameter :: verner_table = 3
  integer, parameter :: fehlberg_table = 4
  integer, parameter :: kutta_merson_table = 5

  !> A method: its name and help for users, and its properties for the procedures that set it up.
  type :: integration_method_type
    character(len=15) :: name
    integer :: family        !< runge_kutta, multistep or automatic
    integer :: table         !< of its coefficients; no_table for multistep methods
    integer :: order         !< of its error; the highest one where it varies
    integer :: stages        !< evaluations of the rate in a step; 0 where their number varies
    logical :: reuses_last   !< the last stage is the first one of the next step
    !> Part of the tolerances by which its steps are judged. Multistep methods make many steps, whose errors have one sign. With
    !> these parts their error at the end of each motion in docs/accuracy.md is at most three times that of prince-dormand, or
    !> a hundred tolerances where that is more.
    real(wp) :: share
    character(len=64) :: help
  end type integration_method_type

  !> All methods, in the order in which they are listed for users.
  type(integration_method_type), parameter :: integration_methods(*) = [ &
    integration_method_type('auto', automatic, no_table, 8, 0, .false., 3.0e-4_wp, &
                            'prince-dormand, and bdf while the motion is stiff'), &
    integration_method_type('prince-dormand', runge_kutta, prince_dormand_table, 8, 13, .false., 1.0_wp, &
                            'Prince-Dormand 8(7), Runge-Kutta'), &
    integration_method_type('dormand-prince', runge_kutta, dormand_prince_table, 5, 7, .true., 1.0_wp, &
                            'Dormand-Prince 5(4), Runge-Kutta'), &
    integration_method_type('verner', runge_kutta, verner_table, 6, 8, .false., 1.0_wp, 'Verner 6(5), Runge-Kutta'), &
    integration_method_type('fehlberg', runge_kutta, fehlberg_table, 8, 13, .false., 1.0_wp, &
                            'Fehlberg 8(7); its error estimate misses forces of time alone'), &
    integration_method_type('merson', runge_kutta, kutta_merson_table, 4, 5, .false., 1.0_wp, &
                            'Kutta-Merson 4(3), the MERSOL of 1995'), &
    integration_method_type('adams', multistep, no_table, 12, 0, .false., 1.0e-3_wp, 'Adams-Moulton, orders 1 to 12'), &
    integration_method_type('bdf', multistep, no_table, 5, 0, .false., 3.0e-4_wp, &
                            'backward differences, orders 1 to 5; for stiff motions')]

  !> The error that is allowed in a step.
  type :: step_tolerance_type
    real(wp) :: relative = 0.0_wp          !< of each variable
    real(wp), allocatable :: absolute(:)   !< of each variable, in its unit
  end type step_tolerance_type

  !> A relative tolerance at which the error of a step still stands above round-off.
  real(wp), parameter :: above_round_off = 1.0e-14_wp

contains

  !> The tolerance by which the steps of a method are judged: its share of the given one, or more where round-off would decide
  !> otherwise.
  pure function tolerance_for(method, given) result(own)
    type(integration_method_type), intent(in) :: method   !< the method
    type(step_tolerance_type), intent(in) :: given        !< as the user gave it
    type(step_tolerance_type) :: own
    real(wp) :: share

    share = max(method%share, min(1.0_wp, above_round_off/given%relative))
    own%relative = share*given%relative
    own%absolute = share*given%absolute
  end function tolerance_for

  !> The least tolerance of a method; smaller ones change nothing, or only what round-off does.
  pure real(wp) function least_tolerance(method)
    type(integration_method_type), intent(in) :: method   !< the method

    least_tolerance = above_round_off/method%share
  end function least_tolerance

  !> Place of a name in the list; 0 where it is not there.
  pure integer function method_index(name)
    character(len=*), intent(in) :: name   !< as in integration_methods, with or without blanks at its end

    do method_index = size(integration_methods), 1, -1
      if (integration_methods(method_index)%name == name) return
    end do
  end function method_index
end module mech9_integration_methods
