# mech9_add_programs(NAME rig PROCEDURES my_pair.f90 old_cam.f ... [LIBRARIES ...])
#
# The programs with the user's own procedures in them: rig_k (kinematics), and rig_d (dynamics)
# where the project has it. PROCEDURES holds submodules of the hooks (mech9_user_pair, ...) and
# whatever they need: free-form or fixed-form sources and object files. They stand before the library
# on the linker's line, so that they replace its answers "no user procedure is linked".
#
# Needs the target mech9::mech9, and MECH9_PROGRAMS_DIR, the folder of the main programs.
function(mech9_add_programs)
  cmake_parse_arguments(PARSE_ARGV 0 arg "" "NAME" "PROCEDURES;LIBRARIES")
  if(NOT arg_NAME OR NOT arg_PROCEDURES OR arg_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "use: mech9_add_programs(NAME rig PROCEDURES my_pair.f90 ... [LIBRARIES ...])")
  endif()

  foreach(source IN LISTS arg_PROCEDURES)
    if(source MATCHES "\\.([fF]|for|FOR|f77)$")
      set_property(SOURCE "${source}" APPEND PROPERTY COMPILE_OPTIONS "${MECH9_FORTRAN77_OPTIONS}")
    endif()
  endforeach()

  foreach(letter k d)
    set(main "${MECH9_PROGRAMS_DIR}/mech9${letter}.f90")
    if(EXISTS "${main}" AND (NOT TARGET mech9 OR TARGET mech9${letter}))   # in this tree: what it builds itself
      set(program ${arg_NAME}_${letter})
      add_executable(${program} "${main}" ${arg_PROCEDURES})
      mech9_guard_memory(${program})
      target_link_libraries(${program} PRIVATE mech9::mech9 ${arg_LIBRARIES})
      # two programs with submodules of one name would otherwise write the same module file
      set_target_properties(${program} PROPERTIES
        Fortran_MODULE_DIRECTORY "${CMAKE_CURRENT_BINARY_DIR}/${program}_modules")
    endif()
  endforeach()
endfunction()

# A program that tells when there is no memory left. Sanitizers have a malloc of their own, and tell it themselves.
function(mech9_guard_memory program)
  string(TOUPPER "${CMAKE_BUILD_TYPE}" kind)
  if(NOT "${CMAKE_Fortran_FLAGS} ${CMAKE_Fortran_FLAGS_${kind}}" MATCHES "-fsanitize")
    target_sources(${program} PRIVATE "${MECH9_PROGRAMS_DIR}/memory_guard.f90")
  endif()
endfunction()
