!> Parts of a file's name: folder, name, ending.
module mech9_path
  use mech9_text, only: lower
  implicit none
  private
  public :: folder_of, name_of, ending_of, with_ending

contains

  !> Length of the folder's name with its slash; 0 where the path names no folder.
  pure integer function last_slash(path) result(place)
    character(len=*), intent(in) :: path   !< a file's name, with or without its folder

    place = index(path, '/', back=.true.)
  end function last_slash

  !> Place of the dot before the ending; the length of the path where there is no ending. A dot at the
  !> beginning of a name (.hidden) belongs to the name.
  pure integer function last_dot(path) result(place)
    character(len=*), intent(in) :: path   !< a file's name, with or without its folder

    place = index(path, '.', back=.true.)
    if (place < last_slash(path) + 2) place = len(path)
  end function last_dot

  !> Length of the path with another ending.
  pure integer function changed_length(path, ending) result(length)
    character(len=*), intent(in) :: path     !< a file's name, with or without its folder
    character(len=*), intent(in) :: ending   !< without the dot; empty: none

    length = last_dot(path)
    if (length < len(path)) length = length - 1
    if (ending /= '') length = length + 1 + len(ending)
  end function changed_length

  !> The folder of a file, with the slash at its end; empty where the path names none.
  pure function folder_of(path) result(folder)
    character(len=*), intent(in) :: path   !< a file's name, with or without its folder
    character(len=last_slash(path)) :: folder

    folder = path
  end function folder_of

  !> The name of a file without its folder.
  pure function name_of(path) result(name)
    character(len=*), intent(in) :: path   !< a file's name, with or without its folder
    character(len=len(path) - last_slash(path)) :: name

    name = path(last_slash(path) + 1:)
  end function name_of

  !> The ending of a file's name in lower case, without the dot: svg, png, csv; empty where it has none.
  pure function ending_of(path) result(ending)
    character(len=*), intent(in) :: path   !< a file's name, with or without its folder
    character(len=len(path) - last_dot(path)) :: ending

    ending = lower(path(last_dot(path) + 1:))
  end function ending_of

  !> The path with another ending, in the place of its own where it has one.
  pure function with_ending(path, ending) result(changed)
    character(len=*), intent(in) :: path     !< a file's name, with or without its folder
    character(len=*), intent(in) :: ending   !< without the dot; empty: none
    character(len=changed_length(path, ending)) :: changed

    changed = path
    if (ending /= '') changed = path(:len(changed) - len(ending) - 1)//'.'//ending
  end function with_ending
end module mech9_path
