!> Parameters, which are names for numbers of the data file that are varied together.
module mech9_parameter
  use mech9_kinds, only: wp
  use mech9_error, only: place_type
  implicit none
  private
  public :: parameter_type, parameter_target_type, formula_result_type

  !> A number of the data file that a parameter sets to factor times its value plus term, in the units of the file.
  type :: parameter_target_type
    character(len=64) :: name = ''    !< as the file writes it: pair(2).point(1)
    character(len=9) :: group = ''    !< of the group, in lower case: pair
    integer :: number = 0             !< place of the group among those of its name, in the order of the file, from 1
    character(len=18) :: item = ''    !< name in the group, in lower case: point
    integer :: position = 0           !< of the number under this name, from 1
    real(wp) :: factor = 1.0_wp
    real(wp) :: term = 0.0_wp
    character(len=16) :: unit = ''    !< as the table of names gives it; may depend on the coordinate and the position
    integer :: coordinate = 0         !< to which the group belongs; 0: to none
    integer :: group_place = 0        !< position of the group in the checked document
    integer :: item_place = 0         !< position of the name in the group of the checked document
  end type parameter_target_type

  type :: parameter_type
    character(len=:), allocatable :: name
    real(wp) :: value = 0.0_wp            !< in the units of the file
    type(parameter_target_type), allocatable :: targets(:)
    type(parameter_target_type), allocatable :: through(:)   !< numbers that formulas set in which it has a part
    logical :: has_range = .false.        !< `low` and `high` are given
    real(wp) :: low = 0.0_wp              !< least value in studies and optimisations
    real(wp) :: high = 0.0_wp             !< largest value
    integer :: count = 0                  !< how many values a grid has from `low` to `high`; 0: not given
    real(wp) :: spread = 0.0_wp           !< standard deviation, or half the width of a uniform distribution; 0: not given
    logical :: uniform = .false.          !< the distribution about `value` is uniform, not normal
    character(len=:), allocatable :: formula   !< from which its value follows while the file is read
    type(place_type) :: place             !< of its group in the data file
    logical :: is_overruled = .false.     !< --set decides on a number that it would set
    character(len=:), allocatable :: note !< a sentence where it and --set contradict each other: which one decides; else empty
  end type parameter_type

  !> A parameter whose value is a formula of others, for messages.
  type :: formula_result_type
    character(len=:), allocatable :: name
    character(len=:), allocatable :: text    !< the formula as the file writes it
    real(wp) :: value = 0.0_wp               !< in the units of the file
    type(parameter_target_type), allocatable :: targets(:)
    character(len=:), allocatable :: note    !< as that of a parameter
    logical :: is_overruled = .false.        !< --set decides on a number that it would set
    integer :: number = 0                    !< of its group among the groups &parameter of the file
  end type formula_result_type
end module mech9_parameter
