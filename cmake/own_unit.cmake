# The presets compile several sources as one unit (CMAKE_UNITY_BUILD): the headers of OpenVDB and GoogleTest are parsed,
# and their templates instantiated, once for eight files. Names in unnamed namespaces must then differ within a room, or
# the file is compiled on its own: those listed by this function, for that reason or because Highway compiles them once
# for each instruction set. The preset debug and the linter compile every file on its own, and so find what a file forgot
# to include.
function(stratum_own_unit)
  set_source_files_properties(${ARGN} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
endfunction()
