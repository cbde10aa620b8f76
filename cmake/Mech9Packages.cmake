# The libraries the project stands on, all from Debian.
find_package(LAPACK REQUIRED)

# The same libraries as files or linker options, for mech9-link, which works without CMake.
set(MECH9_LINK_LIBRARIES ${LAPACK_LIBRARIES} ${LAPACK_LINKER_FLAGS})
