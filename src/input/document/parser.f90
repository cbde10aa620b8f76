!> Namelist text as a document.
module mech9_parser
  use mech9_error, only: error_type
  use mech9_text, only: lower
  use mech9_source, only: source_type, span_type, read_source
  use mech9_document, only: document_type, group_type, item_type, value_type, value_bad, &
                            add_group, add_item, add_value, trim_document
  use mech9_scanner, only: skip_blanks, skip_line, next_is_name, scan_word, scan_subscripts, scan_value, is_letter
  use mech9_diagnostics, only: diagnostics_type
  implicit none
  private
  public :: read_document, parse_document, parse_item

contains

  !> Read a data file. The diagnostics get its errors.
  subroutine read_document(path, document, diagnostics)
    character(len=*), intent(in) :: path                  !< path of the data file
    type(document_type), intent(out) :: document          !< the data file as groups and items
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    type(source_type) :: source
    type(error_type), allocatable :: err

    call read_source(path, source, err)
    call parse_document(source, document, diagnostics, err)
  end subroutine read_document

  !> Read the groups of a text. The first source added to the diagnostics must be the data file.
  pure subroutine parse_document(source, document, diagnostics, failure)
    type(source_type), intent(in) :: source                         !< the text of the data file
    type(document_type), intent(out) :: document                    !< the data file as groups and items
    type(diagnostics_type), intent(inout) :: diagnostics            !< gets the errors
    type(error_type), allocatable, intent(in), optional :: failure  !< the error of reading the source, if there was one
    type(group_type) :: group
    integer :: number, at, count, found

    document%source = source
    call diagnostics%add_source(source, number)
    if (present(failure)) then
      if (allocated(failure)) then
        call diagnostics%add(span_type(), failure%message, failure%code)
        allocate (document%groups(0))
        return
      end if
    end if
    count = 0
    at = 1
    found = diagnostics%count
    do
      call find_group(source%text, at, number, diagnostics)
      if (at > len(source%text)) exit
      call parse_group(source%text, at, number, group, diagnostics)
      call add_group(document%groups, count, group)
    end do
    if (.not. allocated(document%groups)) allocate (document%groups(0))
    call trim_document(document%groups, count)
    if (count == 0 .and. diagnostics%count == found) &
      call diagnostics%add(span_type(), 'there is no group in this file, only blanks and comments')
  end subroutine parse_document

  !> Go on to the & of the next group. Text outside the groups is an error, reported once for each piece of such text.
  pure subroutine find_group(text, at, source, diagnostics)
    character(len=*), intent(in) :: text                  !< the whole text of the source
    integer, intent(inout) :: at                          !< number of a byte: where to begin, then the first byte not taken
    integer, intent(in) :: source                         !< number of the source, for spans
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    integer :: first, line_end
    logical :: reported

    reported = .false.
    do
      call skip_blanks(text, at)
      if (at > len(text)) return
      if (text(at:at) == '&') return
      if (text(at:at) == '$' .and. is_letter(text, at + 1)) then
        call diagnostics%add(span_type(source, at, at), 'a group begins with &, not with $')
        return
      end if
      first = at
      line_end = at
      call skip_line(text, line_end)
      at = line_end
      if (index(text(first:line_end - 1), '&') > 0) at = first + index(text(first:line_end - 1), '&') - 1
      if (.not. reported) call diagnostics%add(span_type(source, first, first + len_trim(text(first:at - 1)) - 1), &
                                           'this stands outside every group; a group begins with & and ends with /'// &
                                           trim(slash_advice(text, first)))
      reported = .true.
    end do
  end subroutine find_group

  !> Advice where a quotient such as 1/2 has ended a group too early: in a data file the slash ends it.
  pure function slash_advice(text, at) result(advice)
    character(len=*), intent(in) :: text  !< the whole text of the source
    integer, intent(in) :: at             !< number of the byte after the slash
    character(len=96) :: advice

    advice = ''
    if (at < 3) return
    if (text(at - 1:at - 1) == '/' .and. scan(text(at - 2:at - 2), '0123456789.') == 1) &
      advice = ' (the / before it ends one; write a quotient as a number, 0.5 instead of 1/2)'
  end function slash_advice

  !> A group from its & to its slash.
  pure subroutine parse_group(text, at, source, group, diagnostics)
    character(len=*), intent(in) :: text                  !< the whole text of the source
    integer, intent(inout) :: at                          !< number of a byte: where to begin, then the first byte not taken
    integer, intent(in) :: source                         !< number of the source, for spans
    type(group_type), intent(out) :: group                !< the group of the data file
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    integer :: first, count
    type(item_type) :: item
    logical :: ended

    first = at
    at = at + 1
    call scan_word(text, at)
    group%name = lower(text(first + 1:at - 1))
    group%span = span_type(source, first, at - 1)
    if (len(group%name) == 0) call diagnostics%add(group%span, 'the name of a group must follow its & at once')
    count = 0
    do
      call end_of_group(text, at, source, group, diagnostics, ended)
      if (ended) exit
      if (next_is_name(text, at)) then
        call parse_item(text, at, source, item, diagnostics)
        call add_item(group%items, count, item)
      else
        call refuse_nameless(text, at, source, diagnostics)
      end if
    end do
    if (.not. allocated(group%items)) allocate (group%items(0))
    group%items = group%items(:count)
  end subroutine parse_group

  !> Whether the group ends here, either properly (/ or &end) or because its slash is missing.
  pure subroutine end_of_group(text, at, source, group, diagnostics, ended)
    character(len=*), intent(in) :: text                  !< the whole text of the source
    integer, intent(inout) :: at                          !< number of a byte: where to begin, then the first byte not taken
    integer, intent(in) :: source                         !< number of the source, for spans
    type(group_type), intent(in) :: group                 !< the group of the data file
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    logical, intent(out) :: ended                         !< whether the group ends here
    integer :: first

    ended = .true.
    call skip_blanks(text, at)
    if (at > len(text)) then
      call diagnostics%add(group%span, 'the group &'//group%name//' has no end: a / is missing')
    else if (text(at:at) == '/') then
      at = at + 1
    else if (text(at:at) == '&') then
      first = at
      at = at + 1
      call scan_word(text, at)
      if (lower(text(first + 1:at - 1)) == 'end') return
      call diagnostics%add(span_type(source, first, at - 1), 'a / is missing before this: the group &'//group%name// &
                           ' has no end')
      at = first
    else
      ended = .false.
    end if
  end subroutine end_of_group

  !> Report text that stands in the place of a name, and go on after it.
  pure subroutine refuse_nameless(text, at, source, diagnostics)
    character(len=*), intent(in) :: text                  !< the whole text of the source
    integer, intent(inout) :: at                          !< number of a byte: where to begin, then the first byte not taken
    integer, intent(in) :: source                         !< number of the source, for spans
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    type(span_type) :: span
    type(value_type) :: value
    integer :: first, found

    first = at
    found = diagnostics%count
    if (text(at:at) == ',') then
      at = at + 1
    else
      call scan_value(text, at, source, value, diagnostics)
    end if
    span = span_type(source, first, at - 1)
    if (diagnostics%count == found) &
      call diagnostics%add(span, 'a name and = are missing before '''//diagnostics%text_of(span)//'''')
    do   ! skip the values after it
      call skip_blanks(text, at)
      if (at > len(text)) return
      if (scan(text(at:at), '/&') > 0 .or. next_is_name(text, at)) return
      found = at
      if (text(at:at) == ',') then
        at = at + 1
      else
        call scan_value(text, at, source, value, diagnostics)
      end if
    end do
  end subroutine refuse_nameless

  !> name = values, or name(subscripts) = values.
  pure subroutine parse_item(text, at, source, item, diagnostics)
    character(len=*), intent(in) :: text                  !< the whole text of the source
    integer, intent(inout) :: at                          !< number of a byte: where the name begins, then the first byte not taken
    integer, intent(in) :: source                         !< number of the source, for spans
    type(item_type), intent(out) :: item                  !< the name with its subscripts and values
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    integer :: first
    logical :: ok

    first = at
    ok = .true.
    call scan_word(text, at)
    item%name = lower(text(first:at - 1))
    item%span = span_type(source, first, at - 1)
    call skip_blanks(text, at)
    if (text(at:at) == '(') then
      call scan_subscripts(text, at, item%subscripts, ok)
      if (.not. ok) then
        deallocate (item%subscripts)
        call diagnostics%add(span_type(source, first, at), 'wrong subscripts; write one as (2), (2:4), (1,:) or (:,1)')
        at = at + index(text(at:), ')')
      end if
    end if
    if (.not. allocated(item%subscripts)) allocate (item%subscripts(0))
    call skip_blanks(text, at)
    at = at + 1                                      ! skip the equals sign
    call parse_values(text, at, source, item%values, diagnostics)
    if (.not. ok) item%values = [value_type(kind=value_bad, span=item%span)]
  end subroutine parse_item

  !> Values up to the next name or the end of the group. An empty place between commas is a null value.
  pure subroutine parse_values(text, at, source, values, diagnostics)
    character(len=*), intent(in) :: text                     !< the whole text of the source
    integer, intent(inout) :: at                             !< number of a byte: where to begin, then the first byte not taken
    integer, intent(in) :: source                            !< number of the source, for spans
    type(value_type), allocatable, intent(out) :: values(:)  !< the values, repeats not yet written out
    type(diagnostics_type), intent(inout) :: diagnostics     !< gets the errors
    type(value_type) :: value
    logical :: after_comma
    integer :: count

    count = 0
    after_comma = .true.
    do
      call skip_blanks(text, at)
      if (at > len(text)) exit
      if (scan(text(at:at), '/&') > 0 .or. next_is_name(text, at)) exit
      if (text(at:at) == ',') then
        if (after_comma) then
          value = value_type(span=span_type(source, at, at))
          call add_value(values, count, value)
        end if
        after_comma = .true.
        at = at + 1
      else
        call scan_value(text, at, source, value, diagnostics)
        call add_value(values, count, value)
        after_comma = .false.
      end if
    end do
    if (.not. allocated(values)) allocate (values(0))
    values = values(:count)
  end subroutine parse_values
end module mech9_parser
