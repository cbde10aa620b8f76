# The files that `cmake --install` puts into place, and the command mech9-link for the build and the install tree. Components:
# programs, mpi, library (libmech9.so.0), development, and python for the wheel (python/pyproject.toml).
include(CMakePackageConfigHelpers)

set(package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/mech9")
set(modules_dir "${CMAKE_INSTALL_INCLUDEDIR}/mech9")
set(data_dir "${CMAKE_INSTALL_DATADIR}/mech9")
set(MECH9_INSTALL_PROGRAMS "${data_dir}/programs")

# mech9-link knows its folders relative to itself once it is installed, so that the tree can be moved.
file(RELATIVE_PATH prefix_from_bin "/${CMAKE_INSTALL_BINDIR}" "/")
string(TOUPPER "${CMAKE_BUILD_TYPE}" kind)
string(STRIP "${CMAKE_Fortran_FLAGS} ${CMAKE_Fortran_FLAGS_${kind}}" link_compile_flags)
string(STRIP "${CMAKE_EXE_LINKER_FLAGS} ${CMAKE_EXE_LINKER_FLAGS_${kind}}" link_linker_flags)
string(REPLACE ";" " " link_fortran77_options "${MECH9_FORTRAN77_OPTIONS}")
string(REPLACE ";" " " link_libraries "${MECH9_LINK_LIBRARIES}")

set(link_letters "")
foreach(letter k d)
  if(TARGET mech9${letter})
    string(APPEND link_letters " ${letter}")
  endif()
endforeach()

set(link_modules "${MECH9_MODULES_DIR}")
set(link_library "${PROJECT_BINARY_DIR}/libmech9.a")
set(link_programs "${MECH9_PROGRAMS_DIR}")
configure_file(cmake/mech9-link.in bin/mech9-link @ONLY
  FILE_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)

set(link_modules "\$here/${prefix_from_bin}${modules_dir}")
set(link_library "\$here/${prefix_from_bin}${CMAKE_INSTALL_LIBDIR}/libmech9.a")
set(link_programs "\$here/${prefix_from_bin}${MECH9_INSTALL_PROGRAMS}")
configure_file(cmake/mech9-link.in install/mech9-link @ONLY)
configure_file(cmake/mech9-link.1.in pages/mech9-link.1 @ONLY)

install(PROGRAMS "${PROJECT_BINARY_DIR}/install/mech9-link" DESTINATION "${CMAKE_INSTALL_BINDIR}" COMPONENT development)
install(FILES "${PROJECT_BINARY_DIR}/pages/mech9-link.1" DESTINATION "${CMAKE_INSTALL_MANDIR}/man1" COMPONENT development)
foreach(program mech9k mech9d)
  if(TARGET ${program})
    install(TARGETS ${program} DESTINATION "${CMAKE_INSTALL_BINDIR}" COMPONENT programs)
    if(TARGET ${program}-mpi)
      install(TARGETS ${program}-mpi DESTINATION "${CMAKE_INSTALL_BINDIR}" COMPONENT mpi)
    endif()
    install(FILES "${MECH9_PROGRAMS_DIR}/${program}.f90" DESTINATION "${MECH9_INSTALL_PROGRAMS}" COMPONENT development)
    install(FILES "${PROJECT_BINARY_DIR}/pages/${program}.1" DESTINATION "${CMAKE_INSTALL_MANDIR}/man1" COMPONENT programs)
    install(FILES "${PROJECT_BINARY_DIR}/pages/${program}.bash"
      DESTINATION "${CMAKE_INSTALL_DATADIR}/bash-completion/completions" RENAME ${program} COMPONENT programs)
  endif()
endforeach()
install(FILES "${MECH9_PROGRAMS_DIR}/memory_guard.f90" "${MECH9_PROGRAMS_DIR}/mech9_auto.f90" "${MECH9_PROGRAMS_DIR}/mech9_special.f90"
  DESTINATION "${MECH9_INSTALL_PROGRAMS}" COMPONENT development)
install(TARGETS mech9 EXPORT mech9Targets DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT development)
# .smod: users' submodules need those of their hooks
install(DIRECTORY "${MECH9_MODULES_DIR}/" DESTINATION "${modules_dir}" COMPONENT development
  FILES_MATCHING PATTERN "*.mod" PATTERN "*.smod")
install(DIRECTORY user_procs DESTINATION "${data_dir}" COMPONENT development)
install(FILES LICENSE README.md CHANGELOG.md DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT programs)

install(EXPORT mech9Targets NAMESPACE mech9:: DESTINATION "${package_dir}" COMPONENT development)
configure_package_config_file(cmake/mech9Config.cmake.in "${PROJECT_BINARY_DIR}/install/mech9Config.cmake"
  INSTALL_DESTINATION "${package_dir}" PATH_VARS MECH9_INSTALL_PROGRAMS)
write_basic_package_version_file("${PROJECT_BINARY_DIR}/install/mech9ConfigVersion.cmake"
  COMPATIBILITY SameMinorVersion)
install(FILES
  "${PROJECT_BINARY_DIR}/install/mech9Config.cmake"
  "${PROJECT_BINARY_DIR}/install/mech9ConfigVersion.cmake"
  cmake/Mech9Programs.cmake
  DESTINATION "${package_dir}" COMPONENT development)

# The library for C and C++: a header, libmech9.so, and what pkg-config and CMake need to find both.
if(MECH9_SHARED)
  install(TARGETS mech9_shared EXPORT mech9SharedTargets
    LIBRARY DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT library NAMELINK_COMPONENT development)
  set_target_properties(mech9_shared PROPERTIES EXPORT_NAME c)
  install(FILES include/mech9.h DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}" COMPONENT development)
  install(EXPORT mech9SharedTargets NAMESPACE mech9:: DESTINATION "${package_dir}" COMPONENT development)
  configure_file(cmake/mech9.pc.in "${PROJECT_BINARY_DIR}/install/mech9.pc" @ONLY)
  install(FILES "${PROJECT_BINARY_DIR}/install/mech9.pc" DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig" COMPONENT development)
endif()

# The Python package holds the library and the programs, as one file, beside its modules.
if(MECH9_PYTHON)
  install(TARGETS mech9_shared LIBRARY DESTINATION mech9 COMPONENT python NAMELINK_SKIP)
  install(TARGETS mech9_both RUNTIME DESTINATION mech9/bin COMPONENT python)
endif()

if(MECH9_DEB)
  include(Mech9Deb)
endif()
