# The tools with what belongs to them: man pages and completions that the tools write themselves, the tables of
# materials, the Blender add-on, the documents.
find_program(GZIP gzip REQUIRED)
set(manuals)
foreach(tool gcode2vdb vdbtrace vdbstudy)
  set(man ${PROJECT_BINARY_DIR}/manuals/${tool}.1.gz)
  set(completion ${PROJECT_BINARY_DIR}/manuals/${tool}.bash)
  add_custom_command(OUTPUT ${man} ${completion} VERBATIM
    COMMAND ${CMAKE_COMMAND} -E make_directory ${PROJECT_BINARY_DIR}/manuals
    COMMAND sh -c "set -e; '$<TARGET_FILE:${tool}>' --write-manual man | '${GZIP}' -9n > '${man}'"
    COMMAND ${tool} --write-manual bash > ${completion}
    DEPENDS ${tool}
    COMMENT "Manual of ${tool}")
  list(APPEND manuals ${man} ${completion})
  install(TARGETS ${tool} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT tools)
  install(FILES ${man} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT tools)
  install(FILES ${completion} DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME ${tool}
    COMPONENT tools)
endforeach()
add_custom_target(manuals ALL DEPENDS ${manuals})

set(data ${CMAKE_INSTALL_DATADIR}/stratum)
install(DIRECTORY data/brdf DESTINATION ${data}/data COMPONENT tools FILES_MATCHING PATTERN "*.bsdf.gz")
install(DIRECTORY tools/blender DESTINATION ${data} COMPONENT tools PATTERN "__pycache__" EXCLUDE)
# With all that they link to, as it lies in the sources: pictures, and the pages and tables of the studies.
install(FILES README.md CHANGELOG.md CONTRIBUTING.md LICENSE NOTICE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT tools)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME copyright COMPONENT tools)
install(DIRECTORY docs DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT tools)
