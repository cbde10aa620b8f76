!> Elements of one document in the tree of another one.
submodule (mech9_xml_tree) mech9_xml_insertion
  implicit none

contains

  !> Put the elements in the root of another document in the place of an element, which is part of the tree no more.
  module subroutine insert(self, element, other)
    class(xml_tree_type), intent(inout) :: self  !< the tree
    integer, intent(in) :: element               !< number of the element, which is not the root
    type(xml_tree_type), intent(in) :: other     !< the other document
    type(element_type), allocatable :: elements(:)
    integer, allocatable :: attributes(:, :)
    integer :: range(2), shift, n

    shift = self%count - 1
    allocate (elements(shift + other%count + 1), attributes(4, self%n_attributes + other%n_attributes + 1))
    elements(:self%count) = self%elements(:self%count)
    elements(self%count + 1:shift + other%count) = other%elements(2:other%count)
    n = self%n_attributes
    attributes(:, :n) = self%attributes(:, :n)
    attributes(:, n + 1:n + other%n_attributes) = other%attributes(:, :other%n_attributes) + self%used
    call shift_elements(elements(self%count + 1:shift + other%count), shift, n, self%used, size(self%files), &
                        elements(element)%depth - 2)
    where (elements(self%count + 1:shift + other%count)%parent == shift + 1) &
      elements(self%count + 1:shift + other%count)%parent = elements(element)%parent
    call self%keep(other%pool(:other%used), range)
    call join_files(self%files, other%files)
    call replace_link(elements, element, merge(other%elements(1)%child + shift, 0, other%elements(1)%child > 0), &
                      other%elements(1)%newest + shift)
    self%count = shift + other%count
    self%n_attributes = n + other%n_attributes
    call move_alloc(elements, self%elements)
    call move_alloc(attributes, self%attributes)
  end subroutine insert

  !> Number elements, attributes, files and bytes of the pool as in the tree to which elements are added.
  pure subroutine shift_elements(elements, shift, attributes, bytes, files, levels)
    type(element_type), intent(inout) :: elements(:)  !< the elements
    integer, intent(in) :: shift                      !< number of elements before them
    integer, intent(in) :: attributes                 !< number of attributes before theirs
    integer, intent(in) :: bytes                      !< number of bytes before theirs
    integer, intent(in) :: files                      !< number of files before theirs
    integer, intent(in) :: levels                     !< number of levels above theirs
    integer :: i

    do i = 1, size(elements)
      associate (e => elements(i))
        e%parent = e%parent + shift
        if (e%child > 0) e%child = e%child + shift
        if (e%newest > 0) e%newest = e%newest + shift
        if (e%next > 0) e%next = e%next + shift
        e%depth = e%depth + levels
        e%file = e%file + files
        e%name = e%name + bytes
        if (e%text(2) > 0) e%text = e%text + bytes
        e%first = e%first + attributes
        e%last = e%last + attributes
      end associate
    end do
  end subroutine shift_elements

  !> Let the neighbours of an element follow and precede a series of others.
  pure subroutine replace_link(elements, element, first, last)
    type(element_type), intent(inout) :: elements(:)  !< all elements
    integer, intent(in) :: element                    !< number of the element that goes
    integer, intent(in) :: first                      !< number of the first of the others; 0: there are none
    integer, intent(in) :: last                       !< number of the last of the others, if there are any
    integer :: parent, before, after

    parent = elements(element)%parent
    after = elements(element)%next
    if (first > 0) then
      elements(last)%next = after
      after = first
    end if
    before = 0
    if (elements(parent)%child == element) then
      elements(parent)%child = after
    else
      before = elements(parent)%child
      do while (elements(before)%next /= element)
        before = elements(before)%next
      end do
      elements(before)%next = after
    end if
    if (elements(parent)%newest == element) elements(parent)%newest = merge(last, before, first > 0)
  end subroutine replace_link

  !> Add paths of files to a list.
  subroutine join_files(files, more)
    type(string_type), allocatable, intent(inout) :: files(:)  !< the list
    type(string_type), intent(in) :: more(:)                   !< the paths
    type(string_type), allocatable :: longer(:)
    integer :: n

    n = size(files)
    allocate (longer(n + size(more)))
    longer(:n) = files
    longer(n + 1:) = more
    call move_alloc(longer, files)
  end subroutine join_files
end submodule mech9_xml_insertion
