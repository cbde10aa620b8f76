# The libraries the project stands on, all from Debian.
# The Python package has what it calls of LAPACK in itself, where there is a static one, not all of it.
if(MECH9_PYTHON)
  set(BLA_STATIC ON)
  find_package(LAPACK QUIET)
  set(BLA_STATIC OFF)
endif()
if(NOT LAPACK_FOUND)
  find_package(LAPACK REQUIRED)
endif()

# SUNDIALS, versions 6 (Debian 12) and 7 (Debian 13). Its own CMake package names Fortran modules at a
# path that does not exist, and looks for PETSc and MPI: its files are found one by one.
find_path(MECH9_SUNDIALS_MODULES fcvode_mod.mod PATH_SUFFIXES sundials/fortran
  DOC "where SUNDIALS' Fortran modules are (Debian: libsundials-fortran-dev)" REQUIRED)
find_file(MECH9_SUNDIALS_CONFIG sundials/sundials_config.h REQUIRED)
mark_as_advanced(MECH9_SUNDIALS_MODULES MECH9_SUNDIALS_CONFIG)
file(STRINGS "${MECH9_SUNDIALS_CONFIG}" version REGEX "#define SUNDIALS_VERSION_MAJOR")
string(REGEX MATCH "[0-9]+" MECH9_SUNDIALS_MAJOR "${version}")
file(STRINGS "${MECH9_SUNDIALS_CONFIG}" version REGEX "#define SUNDIALS_VERSION ")
string(REGEX MATCH "[0-9.]+" MECH9_SUNDIALS_VERSION "${version}")

if(MECH9_SUNDIALS_MAJOR EQUAL 6)
  # static: a program then needs nothing of SUNDIALS where it runs
  set(parts libsundials_farkode_mod.a libsundials_fcvode_mod.a libsundials_arkode.a libsundials_cvode.a)
elseif(MECH9_SUNDIALS_MAJOR EQUAL 7)
  # shared: the core calls MPI, which it brings itself; programs that do not integrate go without
  set(parts sundials_farkode_mod sundials_fcvode_mod sundials_fcore_mod sundials_fnvecserial_mod sundials_nvecserial
    sundials_fsunmatrixdense_mod sundials_fsunlinsoldense_mod sundials_fsunnonlinsolfixedpoint_mod)
  set(MECH9_SUNDIALS_LIBRARIES -Wl,--push-state,--as-needed)
else()
  message(FATAL_ERROR "SUNDIALS ${MECH9_SUNDIALS_MAJOR} was found; versions 6 and 7 are known")
endif()
foreach(part IN LISTS parts)
  find_library(MECH9_${part} ${part} DOC "a part of SUNDIALS" REQUIRED)
  mark_as_advanced(MECH9_${part})
  list(APPEND MECH9_SUNDIALS_LIBRARIES "${MECH9_${part}}")
endforeach()
if(MECH9_SUNDIALS_MAJOR EQUAL 7)
  list(APPEND MECH9_SUNDIALS_LIBRARIES -Wl,--pop-state)
endif()

# Line editing at the terminal; without it lines are read as they come. libedit's functions of variable
# arguments are called as ordinary ones, which on other processors may be another thing.
if(MECH9_LINE_EDITING AND CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|amd64|AMD64|aarch64|arm64)$")
  find_library(MECH9_LIBEDIT edit DOC "libedit (Debian: libedit-dev)")
  mark_as_advanced(MECH9_LIBEDIT)
  if(MECH9_LIBEDIT)
    set(MECH9_LINE_EDITING_LIBRARIES "${MECH9_LIBEDIT}")
  else()
    message(STATUS "libedit was not found: no line editing at the terminal")
  endif()
endif()

# HDF5 with its Fortran modules (Debian: libhdf5-dev), by its files: the package of HDF5 itself brings shared
# libraries only, and those bring some forty others, so that each start of a program would take three times as long.
find_path(MECH9_HDF5_MODULES hdf5.mod PATH_SUFFIXES hdf5/serial
  DOC "where HDF5's Fortran modules are (Debian: libhdf5-dev)" REQUIRED)
mark_as_advanced(MECH9_HDF5_MODULES)
foreach(part libhdf5_serialhl_fortran.a libhdf5_serial_hl.a libhdf5_serial_fortran.a libhdf5_serial.a libsz.a libaec.a libz.a)
  find_library(MECH9_${part} ${part} DOC "a part of HDF5")
  mark_as_advanced(MECH9_${part})
  list(APPEND MECH9_HDF5_STATIC "${MECH9_${part}}")
endforeach()
if(NOT MECH9_HDF5_STATIC MATCHES "NOTFOUND" AND NOT DEFINED MECH9_HDF5_IS_STATIC)
  file(WRITE "${PROJECT_BINARY_DIR}/CMakeFiles/hdf5_static.f90"
    "program hdf5_static\n use hdf5\n use h5ds\n integer :: i\n call h5open_f(i)\n call h5dsset_scale_f(0_hid_t, i)\nend program\n")
  try_compile(MECH9_HDF5_IS_STATIC "${PROJECT_BINARY_DIR}/CMakeFiles/hdf5_static"
    "${PROJECT_BINARY_DIR}/CMakeFiles/hdf5_static.f90"
    CMAKE_FLAGS "-DINCLUDE_DIRECTORIES=${MECH9_HDF5_MODULES}" LINK_LIBRARIES ${MECH9_HDF5_STATIC})
endif()
if(MECH9_HDF5_IS_STATIC)
  set(MECH9_HDF5_LIBRARIES ${MECH9_HDF5_STATIC})
else()
  # HDF5 1.14 of Debian 13 would want curl and crypto besides
  foreach(part hl_fortran _hl _fortran "")
    find_library(MECH9_HDF5${part} NAMES hdf5_serial${part} hdf5${part} DOC "a part of HDF5" REQUIRED)
    mark_as_advanced(MECH9_HDF5${part})
    list(APPEND MECH9_HDF5_LIBRARIES "${MECH9_HDF5${part}}")
  endforeach()
endif()

# expat reads XML, for the import of robots; without it a program says so. Its archive where that can go into a shared library, too,
# which in Debian 13 it cannot.
if(MECH9_IMPORT)
  find_library(MECH9_EXPAT_ARCHIVE libexpat.a DOC "the archive of expat (Debian: libexpat1-dev)")
  if(MECH9_EXPAT_ARCHIVE AND NOT DEFINED MECH9_EXPAT)
    file(WRITE "${PROJECT_BINARY_DIR}/CMakeFiles/expat_archive.f90"
      "subroutine reads_xml() bind(c)\n use, intrinsic :: iso_c_binding\n interface\n  function parser_of(encoding) bind(c, name='XML_ParserCreate')\n"
      "   import c_ptr\n   type(c_ptr), value :: encoding\n   type(c_ptr) :: parser_of\n  end function parser_of\n end interface\n"
      " if (c_associated(parser_of(c_null_ptr))) error stop\nend subroutine reads_xml\n")
    try_compile(expat_goes_into_libraries "${PROJECT_BINARY_DIR}/CMakeFiles/expat_archive" "${PROJECT_BINARY_DIR}/CMakeFiles/expat_archive.f90"
      CMAKE_FLAGS "-DCMAKE_POSITION_INDEPENDENT_CODE=ON" "-DCMAKE_Fortran_FLAGS=-fPIC"
      LINK_OPTIONS -shared LINK_LIBRARIES "${MECH9_EXPAT_ARCHIVE}")
    if(expat_goes_into_libraries)
      set(MECH9_EXPAT "${MECH9_EXPAT_ARCHIVE}" CACHE FILEPATH "expat (Debian: libexpat1-dev)")
    endif()
  endif()
  find_library(MECH9_EXPAT expat DOC "expat (Debian: libexpat1-dev)")
  mark_as_advanced(MECH9_EXPAT MECH9_EXPAT_ARCHIVE)
  if(MECH9_EXPAT)
    set(MECH9_XML_LIBRARY "${MECH9_EXPAT}")
  else()
    message(STATUS "expat was not found: no import of robots")
  endif()
endif()

# NLopt finds what is not a sum of squares in --optimize, and keeps limits; without it a program says so.
if(MECH9_LIMITS)
  find_library(MECH9_NLOPT NAMES libnlopt.a nlopt DOC "NLopt (Debian: libnlopt-dev)")
  mark_as_advanced(MECH9_NLOPT)
  if(MECH9_NLOPT)
    set(MECH9_NLOPT_LIBRARY "${MECH9_NLOPT}")
  else()
    message(STATUS "NLopt was not found: --optimize without limits, and for sums of squares only")
  endif()
endif()

# OpenMP makes the runs of a study in threads; without it a study takes one core. The run-time check of recursion takes two threads
# in one procedure for one, and the sanitizers know nothing of the OpenMP library: builds with these go without.
if(MECH9_THREADS AND NOT CMAKE_BUILD_TYPE MATCHES "^(Debug|Sanitize|Threads)$")
  find_package(OpenMP COMPONENTS Fortran)
  if(OpenMP_Fortran_FOUND)
    set(MECH9_OPENMP_FLAGS ${OpenMP_Fortran_FLAGS})
    set(MECH9_OPENMP_LIBRARIES ${OpenMP_Fortran_LIBRARIES})
  else()
    message(STATUS "OpenMP was not found: the runs of a study take one core")
  endif()
endif()

# MPI makes the runs of a study in several processes. The sanitizers know nothing of its library.
set(MECH9_MPI_FOUND OFF)
if(MECH9_MPI AND NOT CMAKE_BUILD_TYPE MATCHES "^(Sanitize|Threads|Coverage)$")
  find_package(MPI COMPONENTS Fortran)
  if(MPI_Fortran_FOUND AND MPI_Fortran_HAVE_F08_MODULE)
    set(MECH9_MPI_FOUND ON)
  else()
    message(STATUS "MPI was not found (Debian: libopenmpi-dev openmpi-bin): no mech9k-mpi and mech9d-mpi")
  endif()
endif()

# The same libraries as files or linker options, for mech9-link, which works without CMake.
set(MECH9_LINK_LIBRARIES ${MECH9_HDF5_LIBRARIES} ${MECH9_SUNDIALS_LIBRARIES} ${LAPACK_LIBRARIES} ${LAPACK_LINKER_FLAGS}
  ${MECH9_LINE_EDITING_LIBRARIES} ${MECH9_XML_LIBRARY} ${MECH9_NLOPT_LIBRARY}
  ${MECH9_OPENMP_LIBRARIES})
