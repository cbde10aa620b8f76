# The libraries the project stands on, all from Debian.
find_package(LAPACK REQUIRED)

# SUNDIALS, versions 6 (Debian 12) and 7 (Debian 13). Its own CMake package names Fortran modules at a
# path that does not exist, and looks for PETSc and MPI: its files are found one by one.
find_path(MECH9_SUNDIALS_MODULES fcvode_mod.mod PATH_SUFFIXES sundials/fortran
  DOC "where SUNDIALS' Fortran modules are (Debian: libsundials-fortran-dev)" REQUIRED)
find_file(MECH9_SUNDIALS_CONFIG sundials/sundials_config.h REQUIRED)
mark_as_advanced(MECH9_SUNDIALS_MODULES MECH9_SUNDIALS_CONFIG)
file(STRINGS "${MECH9_SUNDIALS_CONFIG}" version REGEX "#define SUNDIALS_VERSION_MAJOR")
string(REGEX MATCH "[0-9]+" MECH9_SUNDIALS_MAJOR "${version}")

if(MECH9_SUNDIALS_MAJOR EQUAL 6)
  # static: a program then needs nothing of SUNDIALS where it runs
  set(parts libsundials_farkode_mod.a libsundials_fcvode_mod.a libsundials_arkode.a libsundials_cvode.a)
elseif(MECH9_SUNDIALS_MAJOR EQUAL 7)
  # shared: the core calls MPI, which it brings itself; programs that do not integrate go without
  set(parts sundials_farkode_mod sundials_fcvode_mod sundials_fcore_mod sundials_fnvecserial_mod
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

# The same libraries as files or linker options, for mech9-link, which works without CMake.
set(MECH9_LINK_LIBRARIES ${MECH9_SUNDIALS_LIBRARIES} ${LAPACK_LIBRARIES} ${LAPACK_LINKER_FLAGS}
  ${MECH9_LINE_EDITING_LIBRARIES})
