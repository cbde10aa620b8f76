!> Lines about the links whose turning motion is recorded: the axis of their angles, or why they have quaternions.
module mech9_turning_text
  use mech9_named_words, only: with_names
  use mech9_kinds, only: wp
  use mech9_text, only: to_text, some_of
  use mech9_model, only: model_type
  use mech9_turning_plane, only: turning_plane_type, find_turning_plane
  implicit none
  private
  public :: print_turning

  !> Most numbers that a list shows.
  integer, parameter :: longest_list = 24

contains

  !> Print the axis about which angles of links are counted, or the pair that makes the mechanism spatial.
  subroutine print_turning(unit, model)
    integer, intent(in) :: unit              !< the output unit
    type(model_type), intent(in) :: model    !< the model
    type(turning_plane_type) :: plane
    character(len=:), allocatable :: links, words

    if (.not. allocated(model%request%output%links)) return
    if (size(model%request%output%links) == 0) return
    links = trim(merge('links', 'link ', size(model%request%output%links) > 1))//' '// &
            some_of(model%request%output%links, longest_list)//': '
    call find_turning_plane(model%mechanism%structure, model%mechanism%pairs, plane)
    if (plane%found) then
      associate (n => plane%normal(:, 1))
        words = 'angle phi about the axis of pair '//to_text(plane%pair)//', which points along ('// &
                to_text(n(1) + 0.0_wp, 4)//', '//to_text(n(2) + 0.0_wp, 4)//', '//to_text(n(3) + 0.0_wp, 4)// &
                ') in link 1; 0 where the axes of both are parallel'
      end associate
    else
      words = 'quaternions in link 1'
      if (plane%barrier > 0) words = words//', since pair '//to_text(plane%barrier)// &
                                     ' leaves the plane across the axis of pair '//to_text(plane%pair)
      if (plane%pair == 0) words = words//', since no pair is revolute'
    end if
    write (unit, '(a)') with_names(model%mechanism%names, links//words)
  end subroutine print_turning
end module mech9_turning_text
