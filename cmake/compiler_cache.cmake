# Where ccache is installed, what was compiled before is not compiled again: another preset's folder, another checkout at
# the same path and another run of CI find it.
find_program(STRATUM_CCACHE ccache DOC "Compiler cache; empty or OFF for none")
if(STRATUM_CCACHE AND PROJECT_IS_TOP_LEVEL AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  # ccache may reuse units that read a precompiled header only when told that nothing in them is a time or a date.
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros ${STRATUM_CCACHE})
  if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
    # The precompiled header has the same bytes then when it is made again.
    add_compile_options("SHELL:-Xclang -fno-pch-timestamp")
  endif()
endif()
