!> The check of a draft, made by reading it as the data file that it will be. Each error gets its place in the draft.
module mech9_draft_check
  use mech9_program_kind, only: dynamics
  use mech9_text, only: to_text
  use mech9_source, only: span_type, source_from_text
  use mech9_grammar, only: item_table, rows_of_group
  use mech9_item_rows, only: takes_kind
  use mech9_structure, only: structure_type
  use mech9_partition, only: partition_type
  use mech9_data_file, only: data_file_type
  use mech9_document, only: document_type
  use mech9_parser, only: parse_document
  use mech9_reader, only: read_structure_only
  use mech9_diagnostics, only: diagnostics_type
  use mech9_draft, only: draft_type
  use mech9_draft_text, only: draft_text_type, write_draft, locate
  use mech9_draft_joints, only: kind_in, numbers_in, number_in, has_joints, pair_with, settle_joints
  use mech9_compound_joint, only: is_compound
  use mech9_outline, only: outline_type
  implicit none
  private
  public :: fault_type, read_draft, read_draft_structure, problem_with, problem_with_joint, faults_of

  !> One error, and the entry of the draft that it concerns.
  type :: fault_type
    character(len=:), allocatable :: message
    integer :: group = 0       !< index in the draft; 0: no group
    integer :: entry = 0       !< number in the group; 0: the group as a whole
  end type fault_type

contains

  !> Read the mechanism of a draft. It is of use only if there are no errors.
  subroutine read_draft(draft, path, program, given, written)
    type(draft_type), intent(in) :: draft               !< groups and names with their values as text
    character(len=*), intent(in) :: path                !< path of the data file; tables of drives are sought beside it
    integer, intent(in) :: program                      !< kinematics, where each independent coordinate needs a drive, or dynamics
    type(data_file_type), intent(inout) :: given        !< a new one; gets the model and the errors
    type(draft_text_type), intent(out) :: written       !< text of the draft, with the place of each entry

    call write_draft(draft, '', written)
    call given%read_text(path, written%text, program)
  end subroutine read_draft

  !> Read the structure of a draft. It is of use only if there are no faults.
  pure subroutine read_draft_structure(draft, outline, structure, partition, faults)
    type(draft_type), intent(in) :: draft                    !< groups and names with their values as text
    type(outline_type), intent(in) :: outline                !< facts known beside the draft
    type(structure_type), intent(out) :: structure           !< links of the pairs
    type(partition_type), intent(out) :: partition         !< kinds of the coordinates, and their order of computation
    type(fault_type), allocatable, intent(out) :: faults(:)  !< errors, each with its entry in the draft
    type(draft_type) :: part
    type(draft_text_type) :: written
    type(diagnostics_type) :: diagnostics

    part = structural_part(draft, outline)
    call read_part(part, structure, partition, written, diagnostics)
    call find_faults(diagnostics, written, faults)
    call translate(part, draft, faults)
  end subroutine read_draft_structure

  !> Read the structural part of a draft like a data file.
  pure subroutine read_part(part, structure, partition, written, diagnostics)
    type(draft_type), intent(in) :: part                   !< draft with the structure alone
    type(structure_type), intent(out) :: structure         !< links of the pairs
    type(partition_type), intent(out) :: partition         !< kinds of the coordinates, and their order of computation
    type(draft_text_type), intent(out) :: written          !< text of the draft, with the place of each entry
    type(diagnostics_type), intent(out) :: diagnostics     !< gets the errors
    type(document_type) :: document

    call write_draft(part, '', written)
    call parse_document(source_from_text('structure', written%text), document, diagnostics)
    call read_structure_only(document, structure, partition, diagnostics)
  end subroutine read_part

  !> The part of a draft that gives the structure: counts and structural data. It has the pairs if they give the
  !> structure or if there are joints with several freedoms. Plain pairs get some kind, since they cannot be read
  !> without one. Where the structure is not given by the pairs, they have the links that it gives them.
  pure function structural_part(draft, outline) result(part)
    type(draft_type), intent(in) :: draft      !< groups and names with their values as text
    type(outline_type), intent(in) :: outline  !< facts known beside the draft
    type(draft_type) :: part
    character(len=11), parameter :: from_pairs(3) = [character(len=11) :: 'coordinate', 'coordinates', 'links']
    integer :: i, j, place
    character(len=:), allocatable :: name, kind
    logical :: with_pairs

    with_pairs = outline%way == 'pairs' .or. has_joints(draft)
    call part%clear()
    do i = 1, size(draft%groups)
      name = draft%groups(i)%name
      if (.not. (name == 'mechanism' .or. name == 'structure' .or. (name == 'pair' .and. with_pairs))) cycle
      place = part%count_of(name) + 1
      do j = 1, size(draft%groups(i)%entries)
        associate (entry => draft%groups(i)%entries(j))
          if (name == 'pair' .and. all(entry%name /= from_pairs)) cycle
          if (name == 'pair' .and. entry%name == 'links' .and. outline%way /= 'pairs') cycle
          call part%give(name, place, entry%name, entry%text)
        end associate
      end do
      if (name /= 'pair') cycle
      kind = kind_in(draft, i)
      if (.not. is_compound(kind)) kind = 'revolute'
      call part%give(name, place, 'kind', ''''//kind//'''')
      call complete(part, name, place, without='links')
      if (outline%way /= 'pairs') call give_links(draft, outline%way, part, place)
    end do
  end function structural_part

  !> Give a pair the links between which its first coordinate stands in the coincidence matrix or in the second set. It
  !> gets none where the coordinate does not stand there.
  pure subroutine give_links(draft, way, part, place)
    type(draft_type), intent(in) :: draft     !< the whole draft
    character(len=*), intent(in) :: way       !< way in which the structure is given: matrix or vectors
    type(draft_type), intent(inout) :: part   !< draft with the structure alone
    integer, intent(in) :: place              !< place of the pair among the pairs of the part
    integer, allocatable :: row(:), nrg(:)
    integer :: i, j, k

    k = number_in(part, 'pair', place)
    if (k == 0) return
    if (way == 'vectors') then
      nrg = numbers_in(draft%value('structure', 1, 'nrg'))
      j = findloc(numbers_in(draft%value('structure', 1, 'nws')), k, dim=1)
      if (j > 1 .and. j <= size(nrg)) call part%give('pair', place, 'links', to_text(nrg(j - 1:j)))
      return
    end if
    do i = 1, draft%number('mechanism', 1, 'links')
      row = numbers_in(draft%value('structure', 1, 'c('//to_text(i)//',:)'))
      j = findloc(row, k, dim=1)
      if (j == 0) cycle
      call part%give('pair', place, 'links', to_text([i, j]))
      return
    end do
  end subroutine give_links

  !> Replace places in a part of a draft by those in the whole, found by names.
  pure subroutine translate(part, draft, faults)
    type(draft_type), intent(in) :: part          !< draft with the structure alone
    type(draft_type), intent(in) :: draft         !< the whole draft
    type(fault_type), intent(inout) :: faults(:)  !< errors whose entries are first those of the part, then those of the whole
    integer :: i, place

    do i = 1, size(faults)
      associate (fault => faults(i))
        if (fault%group == 0) cycle
        associate (name => part%groups(fault%group)%name)
          place = part%place_of(fault%group)
          if (fault%entry > 0) fault%entry = draft%find_entry(name, place, part%groups(fault%group)%entries(fault%entry)%name)
          fault%group = draft%find(name, place)
        end associate
      end associate
    end do
  end subroutine translate

  !> List the errors with the entries of the draft that they concern, in the order in which they were found.
  pure subroutine find_faults(diagnostics, written, faults)
    type(diagnostics_type), intent(in) :: diagnostics        !< gets the errors
    type(draft_text_type), intent(in) :: written             !< text of the draft, with the place of each entry
    type(fault_type), allocatable, intent(out) :: faults(:)  !< errors, each with its entry in the draft
    type(span_type) :: span
    integer :: i

    allocate (faults(diagnostics%known()))
    do i = 1, size(faults)
      call diagnostics%get(i, faults(i)%message, span)
      if (span%source == 1) call locate(written, span%first, faults(i)%group, faults(i)%entry)
    end do
  end subroutine find_faults

  !> List the errors of a draft that was read by read_draft.
  pure subroutine faults_of(diagnostics, written, faults)
    type(diagnostics_type), intent(in) :: diagnostics        !< gets the errors
    type(draft_text_type), intent(in) :: written             !< text of the draft, with the place of each entry
    type(fault_type), allocatable, intent(out) :: faults(:)  !< errors, each with its entry in the draft

    call find_faults(diagnostics, written, faults)
  end subroutine faults_of

  !> Find the errors of one entry of a draft, as far as they can be known now; `problem` is empty if there are none.
  !> Values that the group still lacks are taken from the examples of the table of names.
  subroutine problem_with(draft, outline, path, group, place, name, problem)
    type(draft_type), intent(in) :: draft                  !< groups and names with their values as text
    type(outline_type), intent(in) :: outline              !< facts known beside the draft
    character(len=*), intent(in) :: path                   !< path of the data file; tables of drives are sought beside it
    character(len=*), intent(in) :: group                  !< name of the group
    character(len=*), intent(in) :: name                   !< name with its subscript
    integer, intent(in) :: place                           !< place among the groups of that name, from 1
    character(len=:), allocatable, intent(out) :: problem  !< messages, a line each; empty: nothing is wrong
    type(draft_type) :: trial
    class(data_file_type), allocatable :: given
    type(structure_type) :: structure
    type(partition_type) :: partition
    type(draft_text_type) :: written
    type(diagnostics_type) :: diagnostics
    type(fault_type), allocatable :: faults(:)
    integer :: i

    allocate (given)
    problem = ''
    if (group == 'structure' .or. (group == 'pair' .and. name == 'links' .and. outline%way == 'pairs')) then
      trial = structural_part(draft, outline)
      do i = 1, trial%count_of('pair')
        call complete(trial, 'pair', i)
      end do
      call complete_matrix(trial)
      call read_part(trial, structure, partition, written, diagnostics)
      call find_faults(diagnostics, written, faults)
    else
      trial = draft
      call complete(trial, group, place)
      call read_draft(trial, path, dynamics, given, written)
      call find_faults(given%diagnostics, written, faults)
    end if
    do i = 1, size(faults)
      if (faults(i)%group /= trial%find(group, place) .or. faults(i)%entry /= trial%find_entry(group, place, name)) cycle
      if (problem /= '') problem = problem//new_line('a')
      problem = problem//faults(i)%message
    end do
  end subroutine problem_with

  !> Find the errors of the kind and the coordinates of a pair, once it has as many coordinates as its kind. Without
  !> errors `problem` is empty.
  subroutine problem_with_joint(draft, outline, path, place, problem)
    type(draft_type), intent(in) :: draft                  !< groups and names with their values as text
    type(outline_type), intent(in) :: outline              !< facts known beside the draft
    character(len=*), intent(in) :: path                   !< path of the data file; tables of drives are sought beside it
    integer, intent(in) :: place                           !< place among the pairs, from 1
    character(len=:), allocatable, intent(out) :: problem  !< messages, a line each; empty: nothing is wrong
    type(draft_type) :: trial
    character(len=:), allocatable :: dropped
    integer :: now

    trial = draft
    call settle_joints(trial, dropped)
    now = pair_with(trial, number_in(draft, 'pair', place))
    if (now == 0) now = place
    call problem_with(trial, outline, path, 'pair', now, 'kind', problem)
    if (problem == '' .and. trial%has('pair', now, 'coordinates')) &
      call problem_with(trial, outline, path, 'pair', now, 'coordinates', problem)
  end subroutine problem_with_joint

  !> Take the values that a group needs and lacks from the examples of the table of names.
  pure subroutine complete(draft, group, place, without)
    type(draft_type), intent(inout) :: draft  !< draft whose group is completed
    character(len=*), intent(in) :: group     !< name of the group
    integer, intent(in) :: place              !< place among the groups of that name, from 1
    character(len=*), intent(in), optional :: without  !< name that is not given; not present: all are
    integer, allocatable :: rows(:)
    integer :: i
    character(len=:), allocatable :: kind

    rows = rows_of_group(group)
    if (present(without)) rows = pack(rows, item_table(rows)%name /= without)
    kind = kind_in(draft, draft%find(group, place))
    do i = 1, size(rows)
      associate (row => item_table(rows(i)))
        if (.not. row%needed .or. .not. takes_kind(row, kind)) cycle
        if (draft%has(group, place, trim(row%name))) cycle
        call draft%give(group, place, trim(row%name), trim(row%example))
        if (row%name == 'kind') kind = kind_in(draft, draft%find(group, place))
      end associate
    end do
  end subroutine complete

  !> Fill rows of the coincidence matrix that are not given yet by its symmetry, and otherwise with zeros.
  pure subroutine complete_matrix(draft)
    type(draft_type), intent(inout) :: draft  !< draft whose coincidence matrix is completed
    integer :: n, i, j
    integer, allocatable :: c(:, :)
    logical, allocatable :: given(:)

    n = draft%number('mechanism', 1, 'links')
    if (n < 1 .or. .not. draft%has('structure', 1, 'c(1,:)')) return
    allocate (c(n, n), source=0)
    allocate (given(n))
    do i = 1, n
      given(i) = draft%has('structure', 1, 'c('//to_text(i)//',:)')
      if (given(i)) call take_row(draft%value('structure', 1, 'c('//to_text(i)//',:)'), c(i, :))
    end do
    do i = 1, n
      if (given(i)) cycle
      do j = 1, n
        if (given(j)) c(i, j) = c(j, i)
      end do
      call draft%give('structure', 1, 'c('//to_text(i)//',:)', to_text(c(i, :)))
    end do
  end subroutine complete_matrix

  !> Read numbers from text such as "1, 2, 3". Numbers beyond the size are left out, and missing ones stay as they were.
  pure subroutine take_row(text, numbers)
    character(len=*), intent(in) :: text  !< numbers with commas between them
    integer, intent(inout) :: numbers(:)  !< the numbers; those that are missing in the text stay as they were
    integer :: status
    integer :: read_numbers(size(numbers))

    read_numbers = numbers
    read (text, *, iostat=status) read_numbers
    if (status == 0) numbers = read_numbers
  end subroutine take_row
end module mech9_draft_check
