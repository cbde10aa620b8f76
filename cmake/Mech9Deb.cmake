# Debian packages, one for each component of Mech9Install.cmake: packaging/deb configures, builds and calls cpack.
foreach(needed MECH9_SHARED MECH9_MPI)
  if(NOT ${needed})
    message(FATAL_ERROR "Debian packages need -D${needed}=ON; packaging/deb makes them")
  endif()
endforeach()

install(DIRECTORY python/mech9 DESTINATION lib/python3/dist-packages COMPONENT python3
  PATTERN __pycache__ EXCLUDE PATTERN _programs.py EXCLUDE)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGING_INSTALL_PREFIX "/usr")
# each package has its own first line
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")
set(CPACK_PACKAGE_VERSION "${PROJECT_VERSION}")
set(CPACK_PACKAGE_CONTACT "The MECH9 authors <mech9@example.org>")
set(CPACK_DEBIAN_PACKAGE_RELEASE "1~${MECH9_DEB}")
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_COMPONENTS_ALL programs mpi library development python3)

set(folder "${PROJECT_BINARY_DIR}/deb")
string(TIMESTAMP today "%a, %d %b %Y %H:%M:%S +0000" UTC)

# Describe the package of a component, and give it the files that each Debian package has.
function(mech9_deb component package section summary text)
  string(TOUPPER ${component} upper)
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${package} PARENT_SCOPE)
  set(CPACK_DEBIAN_${upper}_PACKAGE_SECTION ${section} PARENT_SCOPE)
  set(CPACK_COMPONENT_${upper}_DESCRIPTION "${summary}\n${text}" PARENT_SCOPE)
  file(WRITE "${folder}/${package}/changelog.Debian"
    "mech9 (${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE}) unstable; urgency=medium\n\n  * See CHANGELOG.md.\n\n -- ${CPACK_PACKAGE_CONTACT}  ${today}\n")
  execute_process(COMMAND gzip -9nf "${folder}/${package}/changelog.Debian" COMMAND_ERROR_IS_FATAL ANY)
  configure_file(LICENSE "${folder}/${package}/copyright" COPYONLY)
  install(FILES "${folder}/${package}/changelog.Debian.gz" "${folder}/${package}/copyright"
    DESTINATION "share/doc/${package}" COMPONENT ${component})
endfunction()

mech9_deb(programs mech9 science "kinematics and dynamics of spatial mechanisms"
  "The programs mech9k and mech9d analyse spatial mechanisms with closed
chains from structural data: positions, forces, equilibria, vibrations,
studies and synthesis. A user gives numbers and writes no equations.")
mech9_deb(mpi mech9-mpi science "studies and searches in several processes"
  "The programs mech9k-mpi and mech9d-mpi share the runs of a study, or the
starts of a search, among the processes of MPI.")
mech9_deb(library libmech9-0 libs "library for the analysis of spatial mechanisms"
  "The shared library for programs in C, C++ and Python that analyse
spatial mechanisms with closed chains.")
mech9_deb(development libmech9-dev libdevel "development files for the analysis of spatial mechanisms"
  "Header, modules of Fortran and static library for programs that analyse
spatial mechanisms with closed chains, and the command mech9-link, which
links pairs, drives and forces of a user's own.")
mech9_deb(python3 python3-mech9 python "kinematics and dynamics of spatial mechanisms in Python"
  "The package mech9 analyses spatial mechanisms with closed chains and
returns NumPy arrays.")

set(same_version "= ${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE}")
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_SUGGESTS "gnuplot-nox, graphviz, mech9-mpi")
set(CPACK_DEBIAN_MPI_PACKAGE_DEPENDS "openmpi-bin")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS
  "libmech9-0 (${same_version}), gfortran, liblapack-dev, libsundials-dev, libsundials-fortran-dev, libhdf5-dev, libedit-dev, libexpat1-dev, libnlopt-dev")
set(CPACK_DEBIAN_PYTHON3_PACKAGE_DEPENDS "libmech9-0 (${same_version}), python3 (>= 3.9), python3-numpy")
set(CPACK_DEBIAN_PYTHON3_PACKAGE_SUGGESTS "python3-xarray, python3-pandas, python3-h5py, python3-matplotlib, python3-torch")
set(CPACK_DEBIAN_PYTHON3_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_PYTHON3_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SHLIBDEPS OFF)
# Debian keeps the name of a shared library and the package that has it in a file of the package.
file(WRITE "${folder}/shlibs" "libmech9 0 libmech9-0 (>= ${PROJECT_VERSION})\n")
file(WRITE "${folder}/triggers" "activate-noawait ldconfig\n")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_CONTROL_EXTRA "${folder}/shlibs;${folder}/triggers")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_CONTROL_STRICT_PERMISSION ON)

# Python's compiled modules, which belong to no package, are made with it and go with it.
file(WRITE "${folder}/postinst" "#!/bin/sh\nset -e\nif [ \"$1\" = configure ]; then py3compile -p python3-mech9; fi\n")
file(WRITE "${folder}/prerm" "#!/bin/sh\nset -e\npy3clean -p python3-mech9\n")
set(CPACK_DEBIAN_PYTHON3_PACKAGE_CONTROL_EXTRA "${folder}/postinst;${folder}/prerm")
set(CPACK_DEBIAN_PYTHON3_PACKAGE_CONTROL_STRICT_PERMISSION ON)

# Debian wants manual pages compressed.
set(manual "\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_MANDIR}/man1")
install(CODE "execute_process(COMMAND gzip -9nf \"${manual}/mech9k.1\" \"${manual}/mech9d.1\" COMMAND_ERROR_IS_FATAL ANY)"
  COMPONENT programs)
install(CODE "execute_process(COMMAND gzip -9nf \"${manual}/mech9-link.1\" COMMAND_ERROR_IS_FATAL ANY)" COMPONENT development)

include(CPack)
