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
