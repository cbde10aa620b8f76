# Options to choose when configuring, and the compiler flags of each kind of build.
# The user's own flags (FFLAGS, CMAKE_Fortran_FLAGS) are left as they are and come first.
option(MECH9_BUILD_TESTS "build the tests" ${PROJECT_IS_TOP_LEVEL})
option(MECH9_BUILD_BENCH "build the benchmarks of bench/run" OFF)
option(MECH9_NATIVE "use every instruction of this machine (-march=native)" OFF)
option(MECH9_LTO "release: optimise across the files of the computing floors (a fifth faster)" ON)
option(MECH9_SYMBOLS "release: keep the names of procedures in mech9k and mech9d, for profilers" OFF)
option(MECH9_LINE_EDITING "edit lines at the terminal by libedit, where it is found" ON)
option(MECH9_THREADS "make the runs of a study in threads by OpenMP, where it is found" ON)
option(MECH9_MPI "build mech9k-mpi and mech9d-mpi, studies and searches in several processes" OFF)
option(MECH9_SHARED "build libmech9.so, the library for C, C++ and Python" OFF)
option(MECH9_PYTHON "install the library and the programs into the Python package mech9" OFF)
set(MECH9_COMPILED "" CACHE PATH "a build folder whose objects and modules of the library are linked, in place of compiling them (packaging/)")
set(MECH9_DEB "" CACHE STRING "prepare Debian packages of this release of Debian, deb12 or deb13, which cpack makes (packaging/deb)")
option(MECH9_IMPORT "import robots from XML by expat, where it is found" ON)
option(MECH9_LIMITS "keep limits and find what is not a sum of squares by NLopt, where it is found" ON)

if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "kind of build" FORCE)
endif()
set_property(CACHE CMAKE_BUILD_TYPE PROPERTY STRINGS Release Dev Debug Sanitize Threads Coverage)

# Flags for the compiler that knows them; another compiler gets none but the user's own, and those of its kind of build.
set(MECH9_FORTRAN_OPTIONS "")
set(MECH9_FORTRAN77_OPTIONS "")
set(MECH9_SCALAR_COMPILE "")
set(MECH9_LANES_COMPILE "")
if(CMAKE_Fortran_COMPILER_ID STREQUAL "GNU")
  # The language and its warnings, for the project's own sources only. Sums are rounded as they are written and numbers that
  # are not finite are looked for: -ffast-math among the user's flags would break both, silently.
  set(MECH9_FORTRAN_OPTIONS -fno-fast-math -std=f2008 -fimplicit-none -Wall -Wextra -Wpedantic
    -Wno-unused-dummy-argument -Wtrampolines -Werror=implicit-interface)
  # Undoes what would refuse fixed-form FORTRAN 77: implicit types, arithmetic IF, calls without interface.
  set(MECH9_FORTRAN77_OPTIONS -std=legacy -fno-implicit-none -w)
  # Of files whose numbers are read again before they have arrived as vectors (src/CMakeLists.txt).
  set(MECH9_SCALAR_COMPILE -fno-tree-slp-vectorize)

  # Of files whose loops go over designs side by side (src/CMakeLists.txt).
  set(MECH9_LANES_COMPILE -ffp-contract=off)
  if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|amd64|AMD64)$")
    set(MECH9_LANES_avx2 -mavx2)
    set(MECH9_LANES_avx512 -mavx512f -mavx512dq -mavx512vl -mprefer-vector-width=512)
  endif()

  # Optimising gfortran 12 takes the bounds of an array, and the length of a text, that are (re)allocated by an assignment for
  # uninitialized (PR fortran/108889); the debug build still warns of variables that are uninitialized on every way.
  set(mech9_no_false_warnings "-Wno-uninitialized -Wno-maybe-uninitialized")
  set(CMAKE_Fortran_FLAGS_RELEASE "-O2 ${mech9_no_false_warnings}")
  set(CMAKE_Fortran_FLAGS_DEV "-g -O1 ${mech9_no_false_warnings}")
  # Lines of procedures, but not their variables: a sixth of the time of compiling, and half of the programs' size. Optimisation must
  # not take signalling NaNs for quiet ones, which would be no traps any more.
  string(CONCAT CMAKE_Fortran_FLAGS_DEBUG "-g1 -Og -Wno-maybe-uninitialized -fcheck=all,no-array-temps "
    "-finit-real=snan -finit-derived -fsignaling-nans -ffpe-trap=invalid,zero,overflow")
  # The address sanitizer finds null pointers and ends of objects, too: they are not asked for twice. Long procedures call its checks
  # in place of holding them. Both together: a file that copies deep types compiles in a fifth of the time.
  string(CONCAT mech9_sanitizers
    "-fsanitize=address,signed-integer-overflow,shift,integer-divide-by-zero,bounds,float-cast-overflow,bool,return,unreachable "
    "--param asan-instrumentation-with-call-threshold=500 -fno-sanitize-recover=all -fno-omit-frame-pointer")
  foreach(language C Fortran)
    # With -Og the bounds of arrays that are about to be allocated would be taken for overflows of integers.
    set(CMAKE_${language}_FLAGS_SANITIZE "-g1 -O1 ${mech9_sanitizers} ${mech9_no_false_warnings}")
    set(CMAKE_${language}_FLAGS_THREADS "-g1 -Og -fsanitize=thread ${mech9_no_false_warnings}")
    set(CMAKE_${language}_FLAGS_COVERAGE "-g -O0 --coverage")
  endforeach()
  # A function with effects behind .and. or .or. may be left out, which only optimising builds tell; these ones refuse it.
  foreach(type SANITIZE THREADS)
    string(APPEND CMAKE_Fortran_FLAGS_${type} " -ffrontend-optimize -Werror=function-elimination")
  endforeach()

  # The computing floors take most of the time of the tests; all checks stay (bench/measurements.md).
  if(CMAKE_BUILD_TYPE STREQUAL "Debug")
    set(MECH9_FAST_COMPILE -O1)
  endif()

  # How the floors are compiled in an optimised build (src/CMakeLists.txt); procedures that nothing calls are left out of programs.
  if(CMAKE_BUILD_TYPE STREQUAL "Release")
    set(MECH9_FAST_COMPILE -O3)
    list(APPEND MECH9_LANES_COMPILE -O3 --param=max-completely-peel-times=4 -fno-trapping-math)
    # passes that take a third of the time of compiling and make no code smaller are left out
    set(MECH9_SMALL_COMPILE -Os -fno-tree-pre -fno-code-hoisting -fno-gcse -fno-rerun-cse-after-loop -fno-schedule-insns2
      -fno-expensive-optimizations -fno-tree-ccp)
    if(CMAKE_Fortran_COMPILER_VERSION VERSION_GREATER_EQUAL 12)
      list(APPEND MECH9_SMALL_COMPILE -Oz)
    endif()
    set(MECH9_SECTIONS -ffunction-sections -fdata-sections)
    add_compile_options(${MECH9_SECTIONS})
    add_link_options(-Wl,--gc-sections)
    # nothing but debuggers unwinds the stack of Fortran procedures
    set(MECH9_NO_UNWINDING -fno-asynchronous-unwind-tables -fno-unwind-tables)
    add_compile_options("$<$<COMPILE_LANGUAGE:Fortran>:${MECH9_NO_UNWINDING}>")
    if(NOT MECH9_SYMBOLS)
      set(MECH9_STRIP -s)
    endif()
    # Optimisation across files, for the computing floors alone: the archive has them as one object (cmake/archive.in). Their
    # procedures may be put into others although another library could replace them in libmech9.so, which none does.
    if(MECH9_LTO)
      set(MECH9_LTO_COMPILE -flto -fno-fat-lto-objects -fno-semantic-interposition)
    endif()
  endif()
endif()

add_compile_options("$<$<COMPILE_LANGUAGE:Fortran>:${MECH9_FORTRAN_OPTIONS}>")
if(MECH9_NATIVE)
  add_compile_options(-march=native)
endif()
