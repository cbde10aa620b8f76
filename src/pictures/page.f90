!> A page: text that is put together in memory and saved as a file, and what pictures in XML need besides.
!> Uses kinds, error, text, printable, text_file.
module mech9_page
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_text, only: to_text
  use mech9_printable, only: printable
  use mech9_text_file, only: text_file_type
  implicit none
  private
  public :: page_type, xml_text, decimal

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
    procedure :: save => save_page
  end type page_type

contains

  !> Append text.
  pure subroutine put(self, text)
    class(page_type), intent(inout) :: self
    character(len=*), intent(in) :: text
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
    class(page_type), intent(inout) :: self
    character(len=*), intent(in) :: text

    call self%put(text)
    call self%put(line_end)
  end subroutine line

  !> All of it.
  pure function text_of_page(self) result(text)
    class(page_type), intent(in) :: self
    character(len=:), allocatable :: text

    text = ''
    if (self%used > 0) text = self%buffer(:self%used)
  end function text_of_page

  !> Write the page into a file; '-' is standard output. Errors are exit_file.
  subroutine save_page(self, path, err)
    class(page_type), intent(in) :: self
    character(len=*), intent(in) :: path
    type(error_type), allocatable, intent(out) :: err
    type(error_type), allocatable :: close_error
    type(text_file_type) :: file

    call file%open(path, err)
    if (allocated(err)) return
    if (self%used > 0) call file%write(self%buffer(:self%used), err)
    call file%close(close_error)
    if (.not. allocated(err)) call move_alloc(close_error, err)
  end subroutine save_page

  !> Any text as text of an XML document: nothing in it is taken for markup.
  pure function xml_text(text) result(xml)
    character(len=*), intent(in) :: text
    character(len=:), allocatable :: xml
    character(len=len(text)) :: clean
    integer :: i

    clean = printable(text)
    xml = ''
    do i = 1, len(clean)
      select case (clean(i:i))
      case ('&')
        xml = xml//'&amp;'
      case ('<')
        xml = xml//'&lt;'
      case ('>')
        xml = xml//'&gt;'
      case ('"')
        xml = xml//'&quot;'
      case ("'")
        xml = xml//'&#39;'
      case default
        xml = xml//clean(i:i)
      end select
    end do
  end function xml_text

  !> A number with at most two decimals and no more letters than it needs: 12.5, -0.25, 7.
  pure function decimal(number) result(text)
    real(wp), intent(in) :: number               !< of a size that a picture has
    character(len=:), allocatable :: text
    integer :: hundredths, whole, rest

    hundredths = nint(100.0_wp*max(-2.0e7_wp, min(2.0e7_wp, number)))
    whole = abs(hundredths)/100
    rest = mod(abs(hundredths), 100)
    text = to_text(whole)
    if (hundredths < 0) text = '-'//text
    if (rest == 0) return
    text = text//'.'//achar(48 + rest/10)
    if (mod(rest, 10) > 0) text = text//achar(48 + mod(rest, 10))
  end function decimal
end module mech9_page
