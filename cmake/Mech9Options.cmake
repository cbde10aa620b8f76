# What can be chosen when configuring, and the compiler flags of each kind of build.
option(MECH9_BUILD_TESTS "build the tests" ON)
option(MECH9_NATIVE "use every instruction of this machine (-march=native)" OFF)
set(MECH9_SANITIZE "" CACHE STRING "sanitizers, such as address,undefined")

if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "kind of build" FORCE)
endif()

set(CMAKE_Fortran_FLAGS "-std=f2008 -fimplicit-none -Wall -Wextra -Wpedantic -Wno-unused-dummy-argument -Wtrampolines -Werror=implicit-interface")
set(CMAKE_Fortran_FLAGS_RELEASE "-O3")
set(CMAKE_Fortran_FLAGS_DEBUG
  "-g -Og -fcheck=all -finit-real=snan -finit-derived -ffpe-trap=invalid,zero,overflow")
set(CMAKE_Fortran_FLAGS_COVERAGE "-g -O0 --coverage")

if(MECH9_NATIVE)
  add_compile_options(-march=native)
endif()
if(MECH9_SANITIZE)
  add_compile_options(-fsanitize=${MECH9_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer -g)
  add_link_options(-fsanitize=${MECH9_SANITIZE})
endif()
