# The libraries the project stands on, all from Debian.
find_package(LAPACK REQUIRED)
