# With -DSTRATUM_BUNDLE=ON the tools are installed with the libraries that they need, all but those of glibc, for any
# Linux whose glibc is not older than that of the build.
set(bundled_libraries RUNTIME_DEPENDENCY_SET stratum_bundled)
set(bundled_folder lib/stratum)
install(RUNTIME_DEPENDENCY_SET stratum_bundled
  PRE_EXCLUDE_REGEXES "^ld-linux" "^lib(c|m|dl|rt|pthread|resolv)\\.so"
  POST_EXCLUDE_REGEXES "/ld-linux[^/]*$" "/lib(c|m|dl|rt|pthread|resolv)\\.so[^/]*$"
  LIBRARY DESTINATION ${bundled_folder} COMPONENT bundle)
foreach(tool gcode2vdb vdbtrace vdbview vdbmerge vdbstudy)
  # RPATH, not RUNPATH: it also holds for what the libraries themselves need.
  target_link_options(${tool} PRIVATE -Wl,--disable-new-dtags)
  set_target_properties(${tool} PROPERTIES INSTALL_RPATH "$ORIGIN/../${bundled_folder}")
endforeach()
# Without it a tool's start is for the most part look-ups of libopenvdb's own functions.
if(CMAKE_SYSTEM_PROCESSOR STREQUAL "x86_64")
  find_package(Python3 COMPONENTS Interpreter REQUIRED)
  install(CODE "
    file(GLOB libraries \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${bundled_folder}/libopenvdb.so*\")
    foreach(library \${libraries})
      if(NOT IS_SYMLINK \"\${library}\")
        execute_process(COMMAND ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/scripts/bind_own_functions.py \"\${library}\"
          COMMAND_ERROR_IS_FATAL ANY)
      endif()
    endforeach()
  " COMPONENT bundle)
endif()
# The licences of those libraries, as Debian's packages state them.
install(CODE [[
  set(prefix "$ENV{DESTDIR}${CMAKE_INSTALL_PREFIX}")
  file(GLOB libraries "${prefix}/lib/stratum/*.so*")
  foreach(library ${libraries})
    get_filename_component(name ${library} NAME)
    execute_process(COMMAND dpkg-query --search "*/${name}" OUTPUT_VARIABLE owner ERROR_QUIET)
    string(REGEX REPLACE ":.*" "" owner "${owner}")
    if(EXISTS "/usr/share/doc/${owner}/copyright")
      file(COPY_FILE "/usr/share/doc/${owner}/copyright" "${prefix}/lib/stratum/${owner}.copyright" ONLY_IF_DIFFERENT)
    else()
      message(WARNING "${name}: the licence of its package ${owner} is not in /usr/share/doc")
    endif()
  endforeach()
]] COMPONENT bundle)
