# How the archive of the library is made in an optimised build: by the script archive, where the computing floors are compiled together.
if(MECH9_LTO_COMPILE AND NOT MECH9_COMPILED)
  set(computing_list "${PROJECT_BINARY_DIR}/computing.list")
  set(link_together -r -nostdlib -fPIC ${MECH9_FAST_COMPILE} ${MECH9_LTO_COMPILE} -flto-partition=balanced
    -flinker-output=nolto-rel ${MECH9_SECTIONS} ${MECH9_NO_UNWINDING})
  list(JOIN link_together " " link_together)
  configure_file(cmake/archive.in install/archive @ONLY)
  set(CMAKE_Fortran_ARCHIVE_CREATE "sh \"${PROJECT_BINARY_DIR}/install/archive\" <TARGET> <OBJECTS>")
endif()
