!> The files of parts of a search, joined to one file that has the starts of all.
module mech9_starts_merge
  use mech9_kinds, only: wp, long
  use mech9_text, only: string_type, to_text
  use mech9_error, only: error_type, raise, exit_file
  use mech9_hdf5_record, only: copy_provenance
  use mech9_study_definition, only: tell_difference
  use mech9_search_starts, only: start_type
  use mech9_start_rows, only: start_row_type
  use mech9_starts_file, only: starts_file_type
  implicit none
  private
  public :: merge_searches, merged_search_type

  !> The starts of a search that stand in files of its parts.
  type :: merged_search_type
    integer :: starts = 0      !< of the whole search
    integer :: made = 0        !< how many of them the files have
    integer :: repeated = 0    !< starts that more than one file has
  end type merged_search_type

contains

  !> Join the starts of several files to one file. Fail with exit_file where they are not of one search.
  subroutine merge_searches(paths, whole, merged, err)
    type(string_type), intent(in) :: paths(:)             !< of the files
    character(len=*), intent(in) :: whole                 !< path of the file of the whole search
    type(merged_search_type), intent(out) :: merged       !< the starts that the files have
    type(error_type), allocatable, intent(out) :: err     !< allocated if it failed
    type(starts_file_type), allocatable :: files(:)
    type(error_type), allocatable :: at_close
    type(start_type), allocatable :: starts(:)
    integer :: i

    allocate (files(size(paths)))
    call open_files(paths, files, err)
    if (.not. allocated(err)) then
      allocate (starts(maxval(files%layout%wanted)))
      call gather(paths, files, starts, merged%repeated, err)
      if (.not. allocated(err)) call write_whole(whole, files(1), starts, err)
      merged%starts = size(starts)
      merged%made = count([(allocated(starts(i)%found), i=1, size(starts))])
    end if
    do i = 1, size(files)
      call files(i)%close(at_close)
    end do
  end subroutine merge_searches

  !> Open all files. Fail with exit_file where one is not of the search of the first one.
  subroutine open_files(paths, files, err)
    type(string_type), intent(in) :: paths(:)               !< of the files
    type(starts_file_type), intent(inout) :: files(:)       !< the files
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    character(len=:), allocatable :: difference
    integer :: i

    do i = 1, size(files)
      call files(i)%open(paths(i)%text, err)
      if (allocated(err)) return
      call tell_difference(files(1)%layout%definition, files(i)%layout%definition, difference, &
                           'in the first one', 'in the second one')
      if (difference == '' .and. files(i)%layout%row%length() /= files(1)%layout%row%length()) &
        difference = 'their designs have other numbers'
      if (difference == '') cycle
      call raise(err, exit_file, "'"//paths(1)%text//"' and '"//paths(i)%text//"' are of different searches: "//difference// &
                 '; merge files that one data file made with the same changes by --set')
      return
    end do
  end subroutine open_files

  !> Gather the starts of all files. Fail with exit_file where two files have different designs for one start.
  subroutine gather(paths, files, starts, repeated, err)
    type(string_type), intent(in) :: paths(:)               !< of the files
    type(starts_file_type), intent(inout) :: files(:)       !< the files
    type(start_type), intent(inout) :: starts(:)            !< of the whole search, none made
    integer, intent(out) :: repeated                        !< starts that more than one file has
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    type(start_type), allocatable :: of_file(:)
    integer :: i, number

    repeated = 0
    do i = 1, size(files)
      if (allocated(of_file)) deallocate (of_file)
      allocate (of_file(files(i)%layout%wanted))
      call files(i)%read_all(of_file)
      call files(i)%tell(err)
      if (allocated(err)) return
      do number = 1, size(of_file)
        if (.not. allocated(of_file(number)%found)) cycle
        if (.not. allocated(starts(number)%found)) then
          call move_alloc(of_file(number)%found, starts(number)%found)
          cycle
        end if
        repeated = repeated + 1
        if (are_equal(files(1)%layout%row, starts(number), of_file(number))) cycle
        call raise(err, exit_file, "'"//paths(i)%text//"' and a file before it have different designs for start "// &
                   to_text(number)//'; make it anew by the same version of the program')
        return
      end do
    end do
  end subroutine gather

  !> Whether two files have the same bits for a start.
  pure logical function are_equal(row, one, other)
    type(start_row_type), intent(in) :: row        !< extents of the designs
    type(start_type), intent(in) :: one            !< the start in one file
    type(start_type), intent(in) :: other          !< the same start in the other one
    real(wp) :: of_one(row%length()), of_other(row%length())

    call row%pack(one%found, of_one)
    call row%pack(other%found, of_other)
    are_equal = all(transfer(of_one, [0_long]) == transfer(of_other, [0_long]))
  end function are_equal

  !> Write the file of the whole search.
  subroutine write_whole(path, part, starts, err)
    character(len=*), intent(in) :: path                  !< of the file
    type(starts_file_type), intent(inout) :: part         !< the file of the first part
    type(start_type), intent(in) :: starts(:)             !< of the whole search
    type(error_type), allocatable, intent(out) :: err     !< allocated if it failed
    type(starts_file_type) :: whole
    type(error_type), allocatable :: at_close
    integer :: i

    call whole%create_like(path, part, size(starts), err)
    if (allocated(err)) return
    call copy_provenance(part%file, whole%file)
    do i = 1, size(starts)
      if (allocated(starts(i)%found)) call whole%write_start(i, starts(i)%found)
    end do
    call whole%publish(err)
    call whole%close(at_close)
    if (.not. allocated(err)) call move_alloc(at_close, err)
  end subroutine write_whole
end module mech9_starts_merge
