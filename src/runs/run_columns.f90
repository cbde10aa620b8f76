!> The columns of a run, and the record of its section, by its model: they are known before the mechanism is assembled.
module mech9_run_columns
  use mech9_error, only: error_type, raise, exit_data
  use mech9_text, only: texts_of_one_length
  use mech9_model, only: model_type
  use mech9_columns, only: columns_type, kinematic_columns
  use mech9_contact_columns, only: append_contacts
  use mech9_force_record, only: force_record_type
  use mech9_link_record, only: link_record_type
  use mech9_missing_column, only: find_remedy
  use mech9_section_record, only: section_record_type, new_section_record
  implicit none
  private
  public :: find_columns, find_section

contains

  !> The columns of a run. They are known before the mechanism is assembled.
  subroutine find_columns(model, with_energies, with_error, columns, forces, links)
    type(model_type), intent(in) :: model             !< the model
    logical, intent(in) :: with_energies              !< the energies are recorded
    logical, intent(in) :: with_error                 !< an estimated error is recorded
    type(columns_type), intent(out) :: columns        !< all but sensitivities
    type(force_record_type), intent(out) :: forces    !< computes the forces that are recorded
    type(link_record_type), intent(out) :: links      !< computes the motion of links that is recorded

    columns = kinematic_columns(model%mechanism, model%request%output)
    call forces%begin(model, columns)
    call columns%append_motors(model%mechanism)
    if (with_energies) call columns%append_energies()
    call forces%append_magnitudes(model, columns)
    call links%begin(model%mechanism, model%request%output, columns)
    call columns%append_stops(model%mechanism)
    if (model%mechanism%has_frictions() .and. (model%request%output%with_forces() .or. .not. model%is_driven())) &
      call columns%append_frictions(model%mechanism, heats=.not. model%is_driven())
    call append_contacts(columns, model%mechanism)
    call columns%append_in('closure', 'm', 'largest error of a closed chain')
    if (model%request%output%conditioning) call columns%append('conditioning', '1', 'least singular value of the worst chains')
    if (with_error) call columns%append('error', model%mechanism%units%angle_name//','//trim(model%mechanism%units%length_name), &
                                        'estimated error of the coordinates and points')
  end subroutine find_columns

  !> The record of the section that a model requests, with the columns of its run. Fails with exit_data where the column of its value is
  !> not recorded.
  subroutine find_section(model, columns, with_error, record, err)
    type(model_type), intent(in) :: model                  !< the model
    type(columns_type), intent(in) :: columns              !< those of its run
    logical, intent(in) :: with_error                      !< an estimated error is the last one before derivatives
    class(section_record_type), allocatable, intent(out) :: record   !< with its headings; without points
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed
    type(section_record_type), allocatable :: made
    character(len=:), allocatable :: remedy, names(:), units(:)
    integer :: n
    logical :: found

    ! an estimated error is known at outputs alone
    n = columns%count - columns%sensitivities - merge(1, 0, with_error)
    call texts_of_one_length(columns%names(:n), names)
    call texts_of_one_length(columns%units(:n), units)
    allocate (made)
    call new_section_record(model, names, units, columns%motion, made, found)
    call move_alloc(made, record)
    if (found) return
    call find_remedy(model%request%section%column, model, columns, remedy)
    call raise(err, exit_data, 'the section is by column '''//model%request%section%column//''', which is not recorded'//remedy, &
               model%request%section%place)
  end subroutine find_section
end module mech9_run_columns
