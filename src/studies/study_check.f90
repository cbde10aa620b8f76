!> Whether the study of a model can be made.
module mech9_study_check
  use mech9_error, only: error_type, raise, exit_usage, exit_data
  use mech9_text, only: to_text
  use mech9_model, only: model_type
  use mech9_quantity, only: quantity_type
  use mech9_quantity_record, only: quantity_record_type
  use mech9_kinds, only: wp
  use mech9_exponents, only: refuse_exponents
  use mech9_design_run, only: find_quantities, section_of_runs
  use mech9_section_record, only: section_record_type
  implicit none
  private
  public :: check_study

  !> Periods count as a whole number up to this part of them: a data file gives a period with ten digits and more.
  real(wp), parameter :: whole_periods = 1.0e-9_wp

contains

  !> Find the columns of the quantities of a study. Fails with exit_usage where the model has no study, and with exit_data where
  !> its runs cannot record what is requested.
  subroutine check_study(model, quantities, err)
    type(model_type), intent(inout) :: model                !< the model with the values of the data file; gets the class as a quantity
    type(quantity_record_type), intent(out) :: quantities   !< with their columns
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    class(section_record_type), allocatable :: section

    associate (output => model%request%output)
      if (model%request%study%kind == '') then
        call raise(err, exit_usage, '--study carries out the study of a group &study, and this file has none')
      else if (output%with_derivatives()) then
        call raise(err, exit_data, 'a study records no '//trim(merge('sensitivities', 'gradients    ', output%sensitivities))// &
                   ': leave out '//trim(merge('sensitivities', 'gradients    ', output%sensitivities))//' in &output', &
                   output%sensitivities_place)
      else
        call find_quantities(model, quantities, err)
        if (.not. allocated(err)) call section_of_runs(model, section, err)
        if (.not. allocated(err) .and. model%request%study%exponents > 0) call append_exponents(model, quantities, err)
        if (.not. allocated(err) .and. model%request%study%classes) &
          call append_class(model%request%quantities)
        if (.not. allocated(err) .and. model%request%study%carries()) call check_carrying(model, err)
      end if
    end associate
  end subroutine check_study

  !> Append the class as a quantity, of which a study finds the number.
  subroutine append_class(quantities)
    type(quantity_type), allocatable, intent(inout) :: quantities(:)   !< gets it

    call append('class', 'class', quantities)
  end subroutine append_class

  !> Append Lyapunov exponents as quantities, and then their standard errors. Fails with exit_usage where there are not so many, and with
  !> exit_data where they do not exist, or where a parameter or a quantity has one of their names.
  subroutine append_exponents(model, quantities, err)
    type(model_type), intent(inout) :: model                  !< gets them
    type(quantity_record_type), intent(inout) :: quantities   !< learns how many they are
    type(error_type), allocatable, intent(out) :: err         !< allocated if they are refused
    character(len=:), allocatable :: name
    integer :: i, k

    associate (count => model%request%study%exponents)
      call refuse_exponents(model, count, err)
      if (allocated(err)) return
      do k = 1, 2*count
        name = 'L'//to_text(1 + modulo(k - 1, count))
        if (k > count) name = name//'.error'
        if (any([(model%parameters(i)%name == name, i=1, size(model%parameters))]) .or. &
            any([(model%request%quantities(i)%name == name, i=1, size(model%request%quantities))])) then
          call raise(err, exit_data, 'exponents= gives the study a column '''//name//''', and a parameter or a quantity has '// &
                     'this name too; choose another one', model%request%study%place)
          return
        end if
        call append(name, merge('exponent', 'error   ', k <= count), model%request%quantities)
      end do
      quantities%exponents = 2*count
    end associate
  end subroutine append_exponents

  !> Append a quantity of no column. By hand: an array constructor would leak (gfortran 12).
  subroutine append(name, take, quantities)
    character(len=*), intent(in) :: name                               !< its name
    character(len=*), intent(in) :: take                               !< its kind: class, exponent or error
    type(quantity_type), allocatable, intent(inout) :: quantities(:)   !< gets it
    type(quantity_type), allocatable :: all(:)
    integer :: n

    n = size(quantities)
    allocate (all(n + 1))
    all(:n) = quantities
    all(n + 1)%name = name
    all(n + 1)%column = ''
    all(n + 1)%take = take
    call move_alloc(all, quantities)
  end subroutine append

  !> Refuse to carry states on where a run would not begin in the state in which the last one ended.
  subroutine check_carrying(model, err)
    type(model_type), intent(in) :: model                   !< the model
    type(error_type), allocatable, intent(out) :: err       !< allocated if it is refused
    real(wp) :: periods
    integer :: i

    do i = 1, size(model%mechanism%motors)
      if (model%mechanism%motors(i)%motor%has_state()) then
        call raise(err, exit_data, 'a study does not carry on the states of motors: a current with inductance, or an integral; '// &
                   'leave out carry=, or take a motor without a state', model%request%study%place)
        return
      end if
    end do
    associate (section => model%request%section, time => model%request%time)
      if (.not. section%period > 0.0_wp) return
      periods = (time%end - time%start)/section%period
      if (abs(periods - anint(periods)) > whole_periods*max(1.0_wp, abs(periods))) call raise(err, exit_data, &
        'a study that carries states on begins each run at the start of &time: its duration must be a whole number of periods '// &
        'of &section, and it is '//to_text(periods, 9)//'; change end= in &time', model%request%study%place)
    end associate
  end subroutine check_carrying
end module mech9_study_check
