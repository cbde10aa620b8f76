!> Writing of the manual pages and of the completions for the shell into the current folder; a part of the build.
program write_pages_here
  use mech9_pages, only: write_pages
  implicit none

  call write_pages()
end program write_pages_here
