!> The files that keep a study or a search, as they are asked for.
module mech9_kept_files
  implicit none
  private
  public :: kept_files_type

  type :: kept_files_type
    character(len=:), allocatable :: table        !< path; '-' is standard output; empty: none
    character(len=:), allocatable :: hdf5         !< path; empty: none
    logical :: continues = .false.                !< the HDF5 file is there, and gets what is missing in it
    integer :: part(2) = 1                        !< number of the part that is made, and how many parts there are
    character(len=:), allocatable :: part_words   !< the part as the user gave it; empty: the whole, or the part of the file
    logical :: quiet = .true.                     !< no progress is shown
  end type kept_files_type
end module mech9_kept_files
