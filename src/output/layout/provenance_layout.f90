!> The origin of results as data sets, with all data that are needed to compute them again.
module mech9_provenance_layout
  use mech9_text, only: to_text
  use mech9_lapack, only: ilaver
  use mech9_data_set_store, only: data_set_store_type
  use mech9_version, only: version, revision, compiler, sundials_version
  implicit none
  private
  public :: origin_type, write_origin, set_present_time

  !> The origin of results.
  type :: origin_type
    character(len=:), allocatable :: program        !< name of the program that made them
    character(len=:), allocatable :: command_line   !< of the program; empty: there was none
    character(len=:), allocatable :: data_file      !< name of the data file; empty: there was none
    character(len=:), allocatable :: data           !< text of the data file
    character(len=:), allocatable :: began          !< time when the run began
    character(len=:), allocatable :: storage        !< library that writes the file, with its version; empty: not known
  end type origin_type

contains

  !> Write the origin of results.
  subroutine write_origin(store, title, origin)
    class(data_set_store_type), intent(inout) :: store   !< the open storage
    character(len=*), intent(in) :: title                !< of the mechanism
    type(origin_type), intent(in) :: origin              !< of the results

    call store%add_attribute('/', 'title', title)
    call store%add_attribute('/', 'source', origin%program//' '//version)
    call store%put('provenance/program', origin%program, 'program that wrote this file')
    call store%put('provenance/version', version, 'version of the program')
    call store%put('provenance/revision', revision, 'git revision of its sources; empty where unknown')
    call store%put('provenance/compiler', compiler, 'compiler that built it')
    call put_libraries(store, origin%storage)
    call store%put('provenance/created', origin%began, 'when the run began')
    call store%put('provenance/command_line', origin%command_line, 'command line of the run')
    call store%put('provenance/data_file', origin%data_file, 'name of the data file')
    call store%put('provenance/data', origin%data, 'text of the data file')
  end subroutine write_origin

  !> Write the names of the libraries on which the program stands.
  subroutine put_libraries(store, storage)
    class(data_set_store_type), intent(inout) :: store   !< the open storage
    character(len=*), intent(in) :: storage              !< library that writes the file; empty: not known
    character(len=:), allocatable :: text
    integer :: major, minor, patch

    call ilaver(major, minor, patch)
    text = 'SUNDIALS '//sundials_version//', LAPACK '//to_text(major)//'.'//to_text(minor)//'.'//to_text(patch)
    if (storage /= '') text = storage//', '//text
    call store%put('provenance/libraries', text, 'libraries that it stands on')
  end subroutine put_libraries

  !> Tell date and time as 2026-01-31T12:00:00+01:00.
  subroutine set_present_time(text)
    character(len=:), allocatable, intent(out) :: text   !< date and time
    character(len=10) :: date, time, zone

    call date_and_time(date, time, zone)
    text = date(1:4)//'-'//date(5:6)//'-'//date(7:8)//'T'//time(1:2)//':'//time(3:4)//':'//time(5:6)// &
           zone(1:3)//':'//zone(4:5)
  end subroutine set_present_time
end module mech9_provenance_layout
