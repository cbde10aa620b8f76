!> Coefficients of Runge-Kutta methods that SUNDIALS does not bring.
module mech9_butcher_tables
  use mech9_kinds, only: wp
  implicit none
  private
  public :: butcher_table_type, kutta_merson, prince_dormand

  !> An explicit method with an embedded one for its error.
  type :: butcher_table_type
    integer :: stages, order, embedded_order
    real(wp), allocatable :: c(:)      !< times of the stages, as part of the step
    real(wp), allocatable :: a(:, :)   !< (stage, earlier stage)
    real(wp), allocatable :: b(:)      !< weights of the solution
    real(wp), allocatable :: d(:)      !< weights of the embedded solution
  end type butcher_table_type

contains

  !> Kutta and Merson's method, the paper's MERSOL. The difference b - d is Merson's estimate of the error,
  !> (2 k1 - 9 k3 + 8 k4 - k5)/30. The embedded solution is of fifth order where the equations are linear
  !> with constant coefficients, and of third order in general: the step must be chosen by the third.
  pure function kutta_merson() result(table)
    type(butcher_table_type) :: table

    table%stages = 5
    table%order = 4
    table%embedded_order = 3
    table%c = [0.0_wp, 1.0_wp/3.0_wp, 1.0_wp/3.0_wp, 0.5_wp, 1.0_wp]
    allocate (table%a(5, 5), source=0.0_wp)
    table%a(2, 1) = 1.0_wp/3.0_wp
    table%a(3, 1:2) = 1.0_wp/6.0_wp
    table%a(4, 1:3) = [0.125_wp, 0.0_wp, 0.375_wp]
    table%a(5, 1:4) = [0.5_wp, 0.0_wp, -1.5_wp, 2.0_wp]
    table%b = [1.0_wp/6.0_wp, 0.0_wp, 0.0_wp, 2.0_wp/3.0_wp, 1.0_wp/6.0_wp]
    table%d = [0.1_wp, 0.0_wp, 0.3_wp, 0.4_wp, 0.2_wp]
  end function kutta_merson

  !> Prince and Dormand's RK8(7)13M: P. J. Prince, J. R. Dormand, High order embedded Runge-Kutta formulae,
  !> J. Comp. Appl. Math. 7 (1981) 67-75. The fractions approximate the exact coefficients to 18 digits.
  pure function prince_dormand() result(table)
    type(butcher_table_type) :: table

    table%stages = 13
    table%order = 8
    table%embedded_order = 7
    table%c = [0.0_wp, 1.0_wp/18.0_wp, 1.0_wp/12.0_wp, 1.0_wp/8.0_wp, 5.0_wp/16.0_wp, 3.0_wp/8.0_wp, &
      59.0_wp/400.0_wp, 93.0_wp/200.0_wp, 5490023248.0_wp/9719169821.0_wp, 13.0_wp/20.0_wp, &
      1201146811.0_wp/1299019798.0_wp, 1.0_wp, 1.0_wp]
    allocate (table%a(13, 13), source=0.0_wp)
    table%a(2, 1:1) = [1.0_wp/18.0_wp]
    table%a(3, 1:2) = [1.0_wp/48.0_wp, 1.0_wp/16.0_wp]
    table%a(4, 1:3) = [1.0_wp/32.0_wp, 0.0_wp, 3.0_wp/32.0_wp]
    table%a(5, 1:4) = [5.0_wp/16.0_wp, 0.0_wp, -75.0_wp/64.0_wp, 75.0_wp/64.0_wp]
    table%a(6, 1:5) = [3.0_wp/80.0_wp, 0.0_wp, 0.0_wp, 3.0_wp/16.0_wp, 3.0_wp/20.0_wp]
    table%a(7, 1:6) = [29443841.0_wp/614563906.0_wp, 0.0_wp, 0.0_wp, 77736538.0_wp/692538347.0_wp, &
      -28693883.0_wp/1125000000.0_wp, 23124283.0_wp/1800000000.0_wp]
    table%a(8, 1:7) = [16016141.0_wp/946692911.0_wp, 0.0_wp, 0.0_wp, 61564180.0_wp/158732637.0_wp, &
      22789713.0_wp/633445777.0_wp, 545815736.0_wp/2771057229.0_wp, -180193667.0_wp/1043307555.0_wp]
    table%a(9, 1:8) = [39632708.0_wp/573591083.0_wp, 0.0_wp, 0.0_wp, -433636366.0_wp/683701615.0_wp, &
      -421739975.0_wp/2616292301.0_wp, 100302831.0_wp/723423059.0_wp, 790204164.0_wp/839813087.0_wp, &
      800635310.0_wp/3783071287.0_wp]
    table%a(10, 1:9) = [246121993.0_wp/1340847787.0_wp, 0.0_wp, 0.0_wp, -37695042795.0_wp/15268766246.0_wp, &
      -309121744.0_wp/1061227803.0_wp, -12992083.0_wp/490766935.0_wp, 6005943493.0_wp/2108947869.0_wp, &
      393006217.0_wp/1396673457.0_wp, 123872331.0_wp/1001029789.0_wp]
    table%a(11, 1:10) = [-1028468189.0_wp/846180014.0_wp, 0.0_wp, 0.0_wp, 8478235783.0_wp/508512852.0_wp, &
      1311729495.0_wp/1432422823.0_wp, -10304129995.0_wp/1701304382.0_wp, -48777925059.0_wp/3047939560.0_wp, &
      15336726248.0_wp/1032824649.0_wp, -45442868181.0_wp/3398467696.0_wp, 3065993473.0_wp/597172653.0_wp]
    table%a(12, 1:11) = [185892177.0_wp/718116043.0_wp, 0.0_wp, 0.0_wp, -3185094517.0_wp/667107341.0_wp, &
      -477755414.0_wp/1098053517.0_wp, -703635378.0_wp/230739211.0_wp, 5731566787.0_wp/1027545527.0_wp, &
      5232866602.0_wp/850066563.0_wp, -4093664535.0_wp/808688257.0_wp, 3962137247.0_wp/1805957418.0_wp, &
      65686358.0_wp/487910083.0_wp]
    table%a(13, 1:12) = [403863854.0_wp/491063109.0_wp, 0.0_wp, 0.0_wp, -5068492393.0_wp/434740067.0_wp, &
      -411421997.0_wp/543043805.0_wp, 652783627.0_wp/914296604.0_wp, 11173962825.0_wp/925320556.0_wp, &
      -13158990841.0_wp/6184727034.0_wp, 3936647629.0_wp/1978049680.0_wp, -160528059.0_wp/685178525.0_wp, &
      248638103.0_wp/1413531060.0_wp, 0.0_wp]
    table%b = [14005451.0_wp/335480064.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, -59238493.0_wp/1068277825.0_wp, &
      181606767.0_wp/758867731.0_wp, 561292985.0_wp/797845732.0_wp, -1041891430.0_wp/1371343529.0_wp, &
      760417239.0_wp/1151165299.0_wp, 118820643.0_wp/751138087.0_wp, -528747749.0_wp/2220607170.0_wp, &
      1.0_wp/4.0_wp]
    table%d = [13451932.0_wp/455176623.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, -808719846.0_wp/976000145.0_wp, &
      1757004468.0_wp/5645159321.0_wp, 656045339.0_wp/265891186.0_wp, -3867574721.0_wp/1518517206.0_wp, &
      465885868.0_wp/322736535.0_wp, 53011238.0_wp/667516719.0_wp, 2.0_wp/45.0_wp, 0.0_wp]
  end function prince_dormand
end module mech9_butcher_tables
