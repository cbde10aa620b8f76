!> Names that a draft knows, which can be completed where they are typed: of links, pairs, points, parameters, quantities, columns,
!> and of numbers that a parameter sets.
module mech9_known_names
  use mech9_text, only: string_type, to_text
  use mech9_grammar, only: group_table, item_table, item_row_type, find_group_row
  use mech9_grammar_rows, only: refers_to, refers_to_link, refers_to_coordinate
  use mech9_item_rows, only: find_item_rows
  use mech9_part_names, only: part_names_type, name_in
  use mech9_draft, only: draft_type, draft_group_type, plain_name, unquoted
  use mech9_draft_names, only: names_in_draft
  implicit none
  private
  public :: add_names_for, add_known_names, add_word

  !> Ends of columns of coordinates behind a name, and their beginnings before a number.
  character(len=4), parameter :: of_pairs(3) = [character(len=4) :: '.q', '.dq', '.ddq'], of_numbers(3) = ['q   ', 'dq  ', 'ddq ']
  character(len=3), parameter :: of_points(9) = [character(len=3) :: '.x', '.y', '.z', '.vx', '.vy', '.vz', '.ax', '.ay', '.az']
  !> Most words that are offered: a list of more helps nobody.
  integer, parameter :: most_words = 2000

contains

  !> Add the names that an answer to a question about a row of the grammar can hold.
  pure subroutine add_names_for(row, draft, words)
    type(item_row_type), intent(in) :: row                           !< row of the table of names for the question
    type(draft_type), intent(in) :: draft                            !< the data file so far
    type(string_type), allocatable, intent(inout) :: words(:)        !< gets the names

    select case (refers_to(trim(row%group), trim(row%name)))
    case (refers_to_link)
      call add_parts(draft, .true., words)
      return
    case (refers_to_coordinate)
      call add_parts(draft, .false., words)
      return
    end select
    if (row%type /= 'text') return
    select case (row%name)
    case ('point')
      call add_names_of('point', draft, words)
    case ('of', 'over', 'column')
      if (row%kinds == 'quantity') then
        call add_names_of('quantity', draft, words)
      else
        call add_columns(draft, words)
      end if
    case ('formula')
      call add_names_of('parameter', draft, words)
    case ('sets')
      call add_numbers(draft, words)
    end select
  end subroutine add_names_for

  !> Add all names by which a line can call an answer or that it can hold: of groups, of their items, and those that the user gave.
  pure subroutine add_known_names(draft, words)
    type(draft_type), intent(in) :: draft                            !< the data file so far
    type(string_type), allocatable, intent(inout) :: words(:)        !< gets the names
    integer :: i, j

    call add_parts(draft, .true., words)
    call add_parts(draft, .false., words)
    call add_names_of('point', draft, words)
    call add_names_of('parameter', draft, words)
    call add_names_of('quantity', draft, words)
    do i = 1, size(draft%groups)
      call add_word(draft%groups(i)%name, words)
      do j = 1, size(draft%groups(i)%entries)
        call add_word(plain_name(draft%groups(i)%entries(j)%name), words)
      end do
    end do
  end subroutine add_known_names

  !> Add the names of links, or of coordinates.
  pure subroutine add_parts(draft, are_links, words)
    type(draft_type), intent(in) :: draft                            !< the data file so far
    logical, intent(in) :: are_links                                 !< those of links; else of coordinates
    type(string_type), allocatable, intent(inout) :: words(:)        !< gets the names
    type(part_names_type) :: names
    integer :: i

    names = names_in_draft(draft)
    if (are_links) then
      if (.not. allocated(names%links)) return
      do i = 1, size(names%links)
        call add_word(trim(names%links(i)), words)
      end do
    else
      if (.not. allocated(names%coordinates)) return
      do i = 1, size(names%coordinates)
        call add_word(trim(names%coordinates(i)), words)
      end do
    end if
  end subroutine add_parts

  !> Add the names that groups of a kind have.
  pure subroutine add_names_of(group, draft, words)
    character(len=*), intent(in) :: group                            !< name of the groups
    type(draft_type), intent(in) :: draft                            !< the data file so far
    type(string_type), allocatable, intent(inout) :: words(:)        !< gets the names
    integer :: i

    do i = 1, size(draft%groups)
      if (draft%groups(i)%name == group) call add_word(own_name(draft%groups(i)), words)
    end do
  end subroutine add_names_of

  !> The name that a group gives itself; empty where it gives none.
  pure function own_name(group) result(name)
    type(draft_group_type), intent(in) :: group                      !< the group
    character(len=:), allocatable :: name
    integer :: i

    name = ''
    do i = 1, size(group%entries)
      if (group%entries(i)%name == 'name') name = unquoted(group%entries(i)%text)
    end do
  end function own_name

  !> Add the names of columns of coordinates and points.
  pure subroutine add_columns(draft, words)
    type(draft_type), intent(in) :: draft                            !< the data file so far
    type(string_type), allocatable, intent(inout) :: words(:)        !< gets the names
    type(part_names_type) :: names
    integer :: i, k

    names = names_in_draft(draft)
    do k = 1, min(draft%number('mechanism', 1, 'coordinates'), most_words)
      do i = 1, size(of_pairs)
        if (name_in(names%coordinates, k) == '') then
          call add_word(trim(of_numbers(i))//to_text(k), words)
        else
          call add_word(trim(name_in(names%coordinates, k))//trim(of_pairs(i)), words)
        end if
      end do
    end do
    do k = 1, size(draft%groups)
      if (draft%groups(k)%name /= 'point' .or. own_name(draft%groups(k)) == '') cycle
      do i = 1, size(of_points)
        call add_word(own_name(draft%groups(k))//trim(of_points(i)), words)
      end do
    end do
  end subroutine add_columns

  !> Add the names of the numbers of the data file, as a parameter sets them: pair(B).point(1), gravity.acceleration(2).
  pure subroutine add_numbers(draft, words)
    type(draft_type), intent(in) :: draft                            !< the data file so far
    type(string_type), allocatable, intent(inout) :: words(:)        !< gets the names
    character(len=:), allocatable :: group
    integer :: g, i, k, row
    integer, allocatable :: rows(:)

    do g = 1, size(draft%groups)
      row = find_group_row(draft%groups(g)%name)
      if (row == 0 .or. any(draft%groups(g)%name == ['parameter', 'time     ', 'solver   '])) cycle
      group = draft%groups(g)%name
      if (group_table(row)%repeats .and. own_name(draft%groups(g)) /= '') then
        group = group//'('//own_name(draft%groups(g))//')'
      else if (group_table(row)%repeats) then
        group = group//'('//to_text(draft%place_of(g))//')'
      end if
      do i = 1, size(draft%groups(g)%entries)
        associate (entry => draft%groups(g)%entries(i))
          rows = find_item_rows(draft%groups(g)%name, entry%name)
          if (size(rows) == 0) cycle
          if (item_table(rows(1))%type /= 'real') cycle
          if (item_table(rows(1))%high == 1) then
            call add_word(group//'.'//entry%name, words)
          else
            do k = 1, count_of_values(entry%text)
              call add_word(group//'.'//entry%name//'('//to_text(k)//')', words)
            end do
          end if
        end associate
      end do
    end do
  end subroutine add_numbers

  !> How many values a text holds, with commas between them.
  pure integer function count_of_values(text) result(n)
    character(len=*), intent(in) :: text   !< the values
    integer :: i

    n = count([(text(i:i) == ',', i=1, len(text))]) + 1
  end function count_of_values

  !> Add a word that is not in the list yet.
  pure subroutine add_word(word, words)
    character(len=*), intent(in) :: word                             !< the word; an empty one is left out
    type(string_type), allocatable, intent(inout) :: words(:)        !< gets the word
    type(string_type) :: one
    integer :: i

    if (word == '' .or. size(words) >= most_words) return
    do i = 1, size(words)
      if (words(i)%text == word) return
    end do
    one%text = word
    words = [words, one]
  end subroutine add_word
end module mech9_known_names
