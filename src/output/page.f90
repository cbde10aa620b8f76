!> A page: text that is composed in memory and saved as a file.
module mech9_page
  use mech9_error, only: error_type
  use mech9_text_file, only: save_text
  implicit none
  private
  public :: page_type

  character, parameter :: line_end = achar(10)

  !> Text that grows.
  type :: page_type
    private
    character(len=:), allocatable :: buffer
    integer :: used = 0
  contains
    procedure :: put
    procedure :: line
    procedure :: text => text_of_page
    procedure :: is_empty
    procedure :: save => save_page
  end type page_type

contains

  !> Append text.
  pure subroutine put(self, text)
    class(page_type), intent(inout) :: self  !< the page
    character(len=*), intent(in) :: text     !< the text to append
    character(len=:), allocatable :: grown

    if (.not. allocated(self%buffer)) allocate (character(len=65536) :: self%buffer)
    if (self%used + len(text) > len(self%buffer)) then
      allocate (character(len=2*(self%used + len(text))) :: grown)
      grown(:self%used) = self%buffer(:self%used)
      call move_alloc(grown, self%buffer)
    end if
    self%buffer(self%used + 1:self%used + len(text)) = text
    self%used = self%used + len(text)
  end subroutine put

  !> Append text and end the line.
  pure subroutine line(self, text)
    class(page_type), intent(inout) :: self  !< the page
    character(len=*), intent(in) :: text     !< the text to append

    call self%put(text)
    call self%put(line_end)
  end subroutine line

  !> The whole text.
  pure function text_of_page(self) result(text)
    class(page_type), intent(in) :: self  !< the page
    character(len=:), allocatable :: text

    text = ''
    if (self%used > 0) text = self%buffer(:self%used)
  end function text_of_page

  !> Whether the page has no text yet.
  pure logical function is_empty(self)
    class(page_type), intent(in) :: self  !< the page

    is_empty = self%used == 0
  end function is_empty

  !> Write the page into a file; '-' is standard output. Errors are exit_file.
  subroutine save_page(self, path, err)
    class(page_type), intent(in) :: self               !< the page
    character(len=*), intent(in) :: path               !< path of the file; '-' is standard output
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed

    call save_text(path, self%text(), err)
  end subroutine save_page
end module mech9_page
