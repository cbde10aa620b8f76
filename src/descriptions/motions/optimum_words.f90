!> How a search for the best design went, in words.
module mech9_optimum_words
  use mech9_kinds, only: wp
  use mech9_text, only: to_text
  use mech9_counted, only: counted
  use mech9_error, only: error_type
  use mech9_explanation, only: explain
  use mech9_objective, only: quantity_objective
  use mech9_model, only: model_type
  use mech9_run_words, only: duration
  use mech9_synthesis, only: synthesis_type
  use mech9_search, only: optimum_search_type
  implicit none
  private
  public :: print_differences, print_optimum

contains

  !> Print a note where a search will take differences of runs in place of derivatives.
  subroutine print_differences(unit, search)
    integer, intent(in) :: unit                         !< Fortran unit to write to
    type(optimum_search_type), intent(inout) :: search  !< prepared; makes runs for quantities, if it needs any
    type(error_type), allocatable :: err
    logical :: known

    if (.not. allocated(search%synthesis%space%evaluator)) return
    call search%synthesis%space%evaluator%judge_gradient(search%synthesis%space%values, search%start%q, known, err)
    if (known) return
    if (allocated(err)) then
      call explain(err)
      write (unit, '(a)') 'note: the search takes differences of runs in place of derivatives of the quantities: '//err%message
    else
      write (unit, '(a)') 'note: the search takes differences of runs where derivatives of the quantities are not known'
    end if
  end subroutine print_differences

  !> Print how the search went, and the best design.
  subroutine print_optimum(unit, model, synthesis, time)
    integer, intent(in) :: unit                       !< Fortran unit to write to
    type(model_type), intent(in) :: model             !< the model
    type(synthesis_type), intent(in) :: synthesis     !< with its optima, best first
    real(wp), intent(in) :: time                      !< time that the search took [s]
    integer :: i

    write (unit, '(a)') counted(synthesis%done, 'start')//': '//duration(time)//'; '//to_text(synthesis%reached)// &
      ' led to designs that move through the whole run; distinct designs: '//to_text(size(synthesis%optima))
    if (size(synthesis%optima) == 0) return
    write (unit, '(a)') 'least value: '//to_text(synthesis%optima(1)%value, 8)//', from '// &
      counted(synthesis%optima(1)%starts, 'start')
    if ((model%mechanism%units%length_name /= 'm' .or. model%mechanism%units%angle_name /= 'rad') .and. &
        any(model%request%objectives%kind /= quantity_objective)) &
      write (unit, '(a)') '  (distances from targets count in m, angles in rad, whatever the units of the file are)'
    do i = 1, size(synthesis%space%varied)
      associate (parameter => model%parameters(synthesis%space%varied(i)))
        write (unit, '(a)') '  '//parameter%name//' = '//to_text(synthesis%optima(1)%x(i), 12)//at_bound(i)
      end associate
    end do
  contains
    !> Words for a parameter that is at one of its bounds.
    pure function at_bound(i) result(words)
      integer, intent(in) :: i    !< place of the parameter among the varied ones
      character(len=:), allocatable :: words

      words = ''
      if (synthesis%optima(1)%x(i) <= synthesis%space%low(i)) words = ', its low'
      if (synthesis%optima(1)%x(i) >= synthesis%space%high(i)) words = ', its high'
    end function at_bound
  end subroutine print_optimum
end module mech9_optimum_words
