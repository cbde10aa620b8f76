!> An XML document as a tree of elements, each with its attributes and its place in its file. The elements of other documents
!> may be inserted into it.
module mech9_xml_tree
  use mech9_error, only: error_type, raise, exit_data
  use mech9_text, only: string_type, to_text
  use mech9_printable, only: printable
  implicit none
  private
  public :: xml_tree_type, deepest_element

  !> No robot has elements that are nested more deeply; those who read trees may call themselves for elements in elements.
  integer, parameter :: deepest_element = 250

  !> Longer messages are cut, and longer words in them are shortened.
  integer, parameter :: longest_word = 120, longest_message = 3000

  !> One element. Its name and text are ranges of the tree's pool of bytes.
  type :: element_type
    integer :: parent = 0        !< number of the element around it; 0: none
    integer :: child = 0         !< number of the first element in it; 0: none
    integer :: newest = 0        !< number of the last element in it
    integer :: next = 0          !< number of the next element in the same one; 0: none
    integer :: depth = 1         !< number of elements from the root to it, with both
    integer :: file = 1          !< number of its file
    integer :: line = 0          !< place of its beginning in the file, from 1 on
    integer :: column = 0
    integer :: name(2) = 0       !< first and last byte in the pool
    integer :: text(2) = [1, 0]  !< of the text before the first element in it
    integer :: first = 1         !< number of its first attribute
    integer :: last = 0          !< number of its last attribute
  end type element_type

  !> The document. Elements are known by their numbers, in the order in which they begin; 1 is the root, 0 means none.
  type :: xml_tree_type
    type(string_type), allocatable :: files(:)                !< paths of the document and of those that were inserted
    integer :: count = 0                                      !< number of elements
    type(element_type), allocatable, private :: elements(:)
    integer, allocatable, private :: attributes(:, :)         !< (4,n) ranges of name and value in the pool
    integer, private :: n_attributes = 0
    character(len=:), allocatable, private :: pool            !< bytes of names, values and texts
    integer, private :: used = 0                              !< bytes of the pool in use
  contains
    procedure :: begin
    procedure :: add_element
    procedure :: add_attribute
    procedure :: add_text
    procedure :: name
    procedure :: content
    procedure :: has
    procedure :: attribute
    procedure :: parent
    procedure :: first_child
    procedure :: next_sibling
    procedure :: child
    procedure :: next_named
    procedure :: insert
    procedure :: depth
    procedure :: file
    procedure :: line_place
    procedure :: place
    procedure :: fail
    procedure, private :: keep
  end type xml_tree_type

  interface
    !> Put the elements in the root of another document in the place of an element, which is part of the tree no more.
    module subroutine insert(self, element, other)
      class(xml_tree_type), intent(inout) :: self  !< the tree
      integer, intent(in) :: element               !< number of the element, which is not the root
      type(xml_tree_type), intent(in) :: other     !< the other document
    end subroutine insert
  end interface

contains

  !> Make an empty tree.
  subroutine begin(self, path)
    class(xml_tree_type), intent(inout) :: self  !< the tree
    character(len=*), intent(in) :: path         !< the file, as the user named it

    if (allocated(self%files)) deallocate (self%files)
    allocate (self%files(1))
    self%files(1)%text = path
    self%count = 0
    self%n_attributes = 0
    self%used = 0
    if (allocated(self%elements)) deallocate (self%elements, self%attributes, self%pool)
    allocate (self%elements(64), self%attributes(4, 256))
    allocate (character(len=4096) :: self%pool)
  end subroutine begin

  !> Add an element behind those of its parent.
  subroutine add_element(self, parent, name, line, column)
    class(xml_tree_type), intent(inout) :: self  !< the tree
    integer, intent(in) :: parent                !< number of the element around it; 0 for the root
    character(len=*), intent(in) :: name         !< its name
    integer, intent(in) :: line                  !< line of its beginning, from 1 on
    integer, intent(in) :: column                !< column of its beginning, from 1 on
    type(element_type), allocatable :: longer(:)
    integer :: e

    if (self%count == size(self%elements)) then
      allocate (longer(2*self%count))
      longer(:self%count) = self%elements
      call move_alloc(longer, self%elements)
    end if
    e = self%count + 1
    self%count = e
    self%elements(e) = element_type(parent=parent, line=line, column=column, first=self%n_attributes + 1, last=self%n_attributes)
    call self%keep(name, self%elements(e)%name)
    if (parent == 0) return
    self%elements(e)%depth = self%elements(parent)%depth + 1
    if (self%elements(parent)%newest == 0) then
      self%elements(parent)%child = e
    else
      self%elements(self%elements(parent)%newest)%next = e
    end if
    self%elements(parent)%newest = e
  end subroutine add_element

  !> Add an attribute to the newest element.
  subroutine add_attribute(self, name, value)
    class(xml_tree_type), intent(inout) :: self  !< the tree
    character(len=*), intent(in) :: name         !< name of the attribute
    character(len=*), intent(in) :: value        !< its value
    integer, allocatable :: longer(:, :)
    integer :: n

    if (self%n_attributes == size(self%attributes, 2)) then
      allocate (longer(4, 2*self%n_attributes))
      longer(:, :self%n_attributes) = self%attributes
      call move_alloc(longer, self%attributes)
    end if
    n = self%n_attributes + 1
    self%n_attributes = n
    self%elements(self%count)%last = n
    call self%keep(name, self%attributes(:2, n))
    call self%keep(value, self%attributes(3:, n))
  end subroutine add_attribute

  !> Add a piece of text to an element; text behind an element in it is not kept.
  subroutine add_text(self, element, text)
    class(xml_tree_type), intent(inout) :: self  !< the tree
    integer, intent(in) :: element               !< number of the element
    character(len=*), intent(in) :: text         !< the piece
    integer :: range(2)

    if (self%elements(element)%child /= 0) return
    call self%keep(text, range)
    if (self%elements(element)%text(2) == 0) self%elements(element)%text(1) = range(1)
    self%elements(element)%text(2) = range(2)
  end subroutine add_text

  !> Keep bytes in the pool.
  subroutine keep(self, text, range)
    class(xml_tree_type), intent(inout) :: self  !< the tree
    character(len=*), intent(in) :: text         !< the bytes
    integer, intent(out) :: range(2)             !< first and last byte in the pool
    character(len=:), allocatable :: longer

    if (self%used + len(text) > len(self%pool)) then
      allocate (character(len=2*(self%used + len(text))) :: longer)
      longer(:self%used) = self%pool(:self%used)
      call move_alloc(longer, self%pool)
    end if
    range = [self%used + 1, self%used + len(text)]
    self%pool(range(1):range(2)) = text
    self%used = range(2)
  end subroutine keep

  !> The name of an element.
  pure function name(self, element) result(text)
    class(xml_tree_type), intent(in) :: self  !< the tree
    integer, intent(in) :: element            !< number of the element
    character(len=:), allocatable :: text

    associate (range => self%elements(element)%name)
      text = self%pool(range(1):range(2))
    end associate
  end function name

  !> The text of an element, without blanks and line ends around it.
  pure function content(self, element) result(text)
    class(xml_tree_type), intent(in) :: self  !< the tree
    integer, intent(in) :: element            !< number of the element
    character(len=:), allocatable :: text
    character(len=*), parameter :: blanks = ' '//achar(9)//achar(10)//achar(13)
    integer :: first, last

    associate (range => self%elements(element)%text)
      first = verify(self%pool(range(1):range(2)), blanks)
      last = range(1) - 1 + verify(self%pool(range(1):range(2)), blanks, back=.true.)
      ! a part of a text that is assigned to the text itself would be read after its memory is cut
      text = self%pool(range(1) - 1 + max(first, 1):last)
    end associate
  end function content

  !> Number of an attribute; 0 where the element does not have it.
  pure integer function find(self, element, attribute) result(number)
    class(xml_tree_type), intent(in) :: self   !< the tree
    integer, intent(in) :: element             !< number of the element
    character(len=*), intent(in) :: attribute  !< name of the attribute

    do number = self%elements(element)%first, self%elements(element)%last
      associate (range => self%attributes(:, number))
        if (range(2) - range(1) + 1 /= len(attribute)) cycle
        if (self%pool(range(1):range(2)) == attribute) return
      end associate
    end do
    number = 0
  end function find

  !> Whether an element has an attribute.
  pure logical function has(self, element, attribute)
    class(xml_tree_type), intent(in) :: self   !< the tree
    integer, intent(in) :: element             !< number of the element; 0: none, which has no attributes
    character(len=*), intent(in) :: attribute  !< name of the attribute

    has = .false.
    if (element > 0) has = find(self, element, attribute) > 0
  end function has

  !> The value of an attribute; empty where the element does not have it.
  pure function attribute(self, element, name) result(value)
    class(xml_tree_type), intent(in) :: self   !< the tree
    integer, intent(in) :: element             !< number of the element; 0: none, which has no attributes
    character(len=*), intent(in) :: name       !< name of the attribute
    character(len=:), allocatable :: value
    integer :: number

    value = ''
    if (element == 0) return
    number = find(self, element, name)
    if (number > 0) value = self%pool(self%attributes(3, number):self%attributes(4, number))
  end function attribute

  !> The element around an element; 0: none.
  pure integer function parent(self, element)
    class(xml_tree_type), intent(in) :: self  !< the tree
    integer, intent(in) :: element            !< number of the element

    parent = self%elements(element)%parent
  end function parent

  !> The first element in an element; 0: none.
  pure integer function first_child(self, element) result(child)
    class(xml_tree_type), intent(in) :: self  !< the tree
    integer, intent(in) :: element            !< number of the element; 0: none, which has no elements

    child = 0
    if (element > 0) child = self%elements(element)%child
  end function first_child

  !> The next element in the same one; 0: none.
  pure integer function next_sibling(self, element) result(next)
    class(xml_tree_type), intent(in) :: self  !< the tree
    integer, intent(in) :: element            !< number of the element

    next = self%elements(element)%next
  end function next_sibling

  !> The first element of a name in an element; 0: none.
  pure integer function child(self, element, name)
    class(xml_tree_type), intent(in) :: self  !< the tree
    integer, intent(in) :: element            !< number of the element; 0: none, which has no elements
    character(len=*), intent(in) :: name      !< the name that is looked for

    child = self%first_child(element)
    if (child > 0) then
      if (.not. is_named(self, child, name)) child = self%next_named(child, name)
    end if
  end function child

  !> The next element of a name in the same element; 0: none.
  pure integer function next_named(self, element, name) result(next)
    class(xml_tree_type), intent(in) :: self  !< the tree
    integer, intent(in) :: element            !< number of an element before it
    character(len=*), intent(in) :: name      !< the name that is looked for

    next = self%elements(element)%next
    do while (next > 0)
      if (is_named(self, next, name)) return
      next = self%elements(next)%next
    end do
  end function next_named

  !> Whether an element has a name. Blanks at ends count.
  pure logical function is_named(self, element, name)
    class(xml_tree_type), intent(in) :: self  !< the tree
    integer, intent(in) :: element            !< number of the element
    character(len=*), intent(in) :: name      !< the name

    associate (range => self%elements(element)%name)
      is_named = range(2) - range(1) + 1 == len(name)
      if (is_named) is_named = self%pool(range(1):range(2)) == name
    end associate
  end function is_named

  !> The number of elements from the root to an element, with both.
  pure integer function depth(self, element)
    class(xml_tree_type), intent(in) :: self  !< the tree
    integer, intent(in) :: element            !< number of the element

    depth = self%elements(element)%depth
  end function depth

  !> The number of the file in which an element stands.
  pure integer function file(self, element)
    class(xml_tree_type), intent(in) :: self  !< the tree
    integer, intent(in) :: element            !< number of the element

    file = self%elements(element)%file
  end function file

  !> The place of an element for notes: file and line.
  pure function line_place(self, element) result(text)
    class(xml_tree_type), intent(in) :: self  !< the tree
    integer, intent(in) :: element            !< number of the element
    character(len=:), allocatable :: text

    text = self%files(self%elements(element)%file)%text//':'//to_text(self%elements(element)%line)
  end function line_place

  !> The place of an element for messages: file, line and column.
  pure function place(self, element) result(text)
    class(xml_tree_type), intent(in) :: self  !< the tree
    integer, intent(in) :: element            !< number of the element
    character(len=:), allocatable :: text

    text = self%line_place(element)//':'//to_text(self%elements(element)%column)
  end function place

  !> Fail because of an element; an earlier failure stays.
  subroutine fail(self, element, message, err, code)
    class(xml_tree_type), intent(in) :: self             !< the tree
    integer, intent(in) :: element                       !< number of the element
    character(len=*), intent(in) :: message              !< the error in words
    type(error_type), allocatable, intent(inout) :: err  !< the failure
    integer, intent(in), optional :: code                !< its exit code; exit_data unless it is given
    integer :: kind

    if (allocated(err)) return
    kind = exit_data
    if (present(code)) kind = code
    call raise(err, kind, printable(self%place(element)//': '//shortened(message)))
  end subroutine fail

  !> A message whose words are short: a word of a hostile file may have millions of characters.
  pure function shortened(message) result(short)
    character(len=*), intent(in) :: message  !< in words
    character(len=:), allocatable :: short
    integer :: first, last

    short = ''
    first = 1
    do while (first <= len(message) .and. len(short) < longest_message)
      last = index(message(first:), ' ')
      last = merge(len(message), first + last - 1, last == 0)
      if (last - first < longest_word) then
        short = short//message(first:last)
      else
        short = short//message(first:first + longest_word/2)//'...'//message(last - longest_word/4:last)
      end if
      first = last + 1
    end do
  end function shortened
end module mech9_xml_tree
