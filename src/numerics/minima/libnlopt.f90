!> Interfaces of the functions of NLopt that this program calls, as declared in nlopt.h.
module mech9_libnlopt
  use, intrinsic :: iso_c_binding, only: c_int, c_double, c_char, c_ptr, c_funptr
  implicit none
  private
  public :: algorithm_of_name, create, destroy, set_lower_bounds, set_upper_bounds, set_objective, add_limits, &
    set_change_of_place, set_change_of_value, set_most_evaluations, set_local_optimizer, force_stop, optimize

  interface
    !> Number of an algorithm; negative where it does not exist.
    integer(c_int) function algorithm_of_name(name) bind(c, name='nlopt_algorithm_from_string')
      import :: c_int, c_char
      character(kind=c_char), intent(in) :: name(*)   !< as LD_SLSQP, ending with a byte of zero
    end function algorithm_of_name

    !> A new search; null where there is no memory.
    type(c_ptr) function create(algorithm, n) bind(c, name='nlopt_create')
      import :: c_ptr, c_int
      integer(c_int), value :: algorithm   !< its number
      integer(c_int), value :: n           !< number of unknowns
    end function create

    !> Free a search.
    subroutine destroy(search) bind(c, name='nlopt_destroy')
      import :: c_ptr
      type(c_ptr), value :: search   !< address of the search
    end subroutine destroy

    !> Set the least values of the unknowns.
    integer(c_int) function set_lower_bounds(search, bounds) bind(c, name='nlopt_set_lower_bounds')
      import :: c_ptr, c_int, c_double
      type(c_ptr), value :: search              !< address of the search
      real(c_double), intent(in) :: bounds(*)   !< (n) the bounds
    end function set_lower_bounds

    !> Set the largest values of the unknowns.
    integer(c_int) function set_upper_bounds(search, bounds) bind(c, name='nlopt_set_upper_bounds')
      import :: c_ptr, c_int, c_double
      type(c_ptr), value :: search              !< address of the search
      real(c_double), intent(in) :: bounds(*)   !< (n) the bounds
    end function set_upper_bounds

    !> Set the function that should be least.
    integer(c_int) function set_objective(search, function, data) bind(c, name='nlopt_set_min_objective')
      import :: c_ptr, c_funptr, c_int
      type(c_ptr), value :: search         !< address of the search
      type(c_funptr), value :: function    !< the function
      type(c_ptr), value :: data           !< its last argument
    end function set_objective

    !> Add functions that must not be positive.
    integer(c_int) function add_limits(search, m, function, data, tolerances) bind(c, name='nlopt_add_inequality_mconstraint')
      import :: c_ptr, c_funptr, c_int, c_double
      type(c_ptr), value :: search                  !< address of the search
      integer(c_int), value :: m                    !< their number
      type(c_funptr), value :: function             !< all of them
      type(c_ptr), value :: data                    !< its last argument
      real(c_double), intent(in) :: tolerances(*)   !< (m) of each
    end function add_limits

    !> End where all unknowns change by less.
    integer(c_int) function set_change_of_place(search, change) bind(c, name='nlopt_set_xtol_abs1')
      import :: c_ptr, c_int, c_double
      type(c_ptr), value :: search        !< address of the search
      real(c_double), value :: change     !< of each unknown
    end function set_change_of_place

    !> End where the function changes by less.
    integer(c_int) function set_change_of_value(search, change) bind(c, name='nlopt_set_ftol_rel')
      import :: c_ptr, c_int, c_double
      type(c_ptr), value :: search        !< address of the search
      real(c_double), value :: change     !< as a part of the function
    end function set_change_of_value

    !> End after a number of evaluations.
    integer(c_int) function set_most_evaluations(search, count) bind(c, name='nlopt_set_maxeval')
      import :: c_ptr, c_int
      type(c_ptr), value :: search     !< address of the search
      integer(c_int), value :: count   !< their number
    end function set_most_evaluations

    !> Set the search that a search by Lagrange's multipliers makes for each of their values; it is copied.
    integer(c_int) function set_local_optimizer(search, local) bind(c, name='nlopt_set_local_optimizer')
      import :: c_ptr, c_int
      type(c_ptr), value :: search   !< address of the search
      type(c_ptr), value :: local    !< address of the other search
    end function set_local_optimizer

    !> End a search from within its functions.
    integer(c_int) function force_stop(search) bind(c, name='nlopt_force_stop')
      import :: c_ptr, c_int
      type(c_ptr), value :: search   !< address of the search
    end function force_stop

    !> Make a search.
    integer(c_int) function optimize(search, x, value) bind(c, name='nlopt_optimize')
      import :: c_ptr, c_int, c_double
      type(c_ptr), value :: search              !< address of the search
      real(c_double), intent(inout) :: x(*)     !< (n) the start, then the place of the least value
      real(c_double), intent(out) :: value      !< the least value
    end function optimize
  end interface
end module mech9_libnlopt
