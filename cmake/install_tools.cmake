# The tools with what belongs to them: man pages and completions that the tools write themselves, the tables of
# materials, the Blender add-on, the documents.
find_program(GZIP gzip REQUIRED)
set(bundled_libraries)
if(STRATUM_BUNDLE)
  include(cmake/bundle.cmake)
endif()
set(manuals)
string(REPLACE ";" " " emulator "${CMAKE_CROSSCOMPILING_EMULATOR}")
foreach(tool gcode2vdb vdbtrace vdbview vdbmerge vdbstudy)
  set(man ${PROJECT_BINARY_DIR}/manuals/${tool}.1.gz)
  set(completion ${PROJECT_BINARY_DIR}/manuals/${tool}.bash)
  add_custom_command(OUTPUT ${man} ${completion} VERBATIM
    COMMAND ${CMAKE_COMMAND} -E make_directory ${PROJECT_BINARY_DIR}/manuals
    COMMAND sh -c "set -e; ${emulator} '$<TARGET_FILE:${tool}>' --write-manual man | '${GZIP}' -9n > '${man}'"
    COMMAND ${tool} --write-manual bash > ${completion}
    DEPENDS ${tool}
    COMMENT "Manual of ${tool}")
  list(APPEND manuals ${man} ${completion})
  set(component tools)
  if(tool STREQUAL vdbview)
    set(component viewer)
  endif()
  install(TARGETS ${tool} ${bundled_libraries} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT ${component})
  install(FILES ${man} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT ${component})
  install(FILES ${completion} DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME ${tool}
    COMPONENT ${component})
endforeach()
add_custom_target(manuals ALL DEPENDS ${manuals})

set(data ${CMAKE_INSTALL_DATADIR}/stratum)
install(DIRECTORY data/brdf DESTINATION ${data}/data COMPONENT tools FILES_MATCHING PATTERN "*.bsdf.gz")
install(DIRECTORY data/filaments DESTINATION ${data}/data COMPONENT tools)
# One zip for all Blenders: the folder in it is an add-on for 3.4, and an extension for 4.2 and later.
set(addon stratum_import-${PROJECT_VERSION}.zip)
set(addon_files)
foreach(file __init__.py blender_manifest.toml conversion.py materials.py objects.py ply.py session.py settings.py)
  list(APPEND addon_files stratum_import/${file})
endforeach()
list(TRANSFORM addon_files PREPEND ${PROJECT_SOURCE_DIR}/tools/blender/ OUTPUT_VARIABLE addon_sources)
add_custom_command(OUTPUT ${PROJECT_BINARY_DIR}/${addon} VERBATIM
  COMMAND ${CMAKE_COMMAND} -E tar cf ${PROJECT_BINARY_DIR}/${addon} --format=zip --mtime=2026-01-01 ${addon_files}
  WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}/tools/blender
  DEPENDS ${addon_sources}
  COMMENT "Blender add-on")
add_custom_target(blender_addon ALL DEPENDS ${PROJECT_BINARY_DIR}/${addon})
install(FILES ${PROJECT_BINARY_DIR}/${addon} DESTINATION ${data}/blender COMPONENT tools)
# How desktops know the viewer and the files it opens: https://specifications.freedesktop.org
configure_file(data/desktop/org.stratum.vdbview.metainfo.xml ${PROJECT_BINARY_DIR}/desktop/org.stratum.vdbview.metainfo.xml @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/desktop/org.stratum.vdbview.metainfo.xml DESTINATION ${CMAKE_INSTALL_DATADIR}/metainfo
  COMPONENT viewer)
install(FILES data/desktop/org.stratum.vdbview.desktop DESTINATION ${CMAKE_INSTALL_DATADIR}/applications COMPONENT viewer)
install(FILES data/desktop/org.stratum.vdbview.svg DESTINATION ${CMAKE_INSTALL_DATADIR}/icons/hicolor/scalable/apps
  COMPONENT viewer)
install(FILES data/desktop/stratum.mime.xml DESTINATION ${CMAKE_INSTALL_DATADIR}/mime/packages RENAME stratum.xml
  COMPONENT viewer)
# Neither in a tarball nor in a wheel: most of the size, and what is for the system.
set(with_system tools)
if(STRATUM_BUNDLE OR SKBUILD)
  set(with_system system)
endif()
# Thumbnails of all that arrives in a folder (docs/print_farm.md).
install(PROGRAMS data/print_farm/stratum-thumbnails DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT tools)
install(FILES data/print_farm/stratum-thumbnails@.path data/print_farm/stratum-thumbnails@.service
  DESTINATION lib/systemd/system COMPONENT ${with_system})
# With all that they link to, as it lies in the sources: pictures, and the pages and tables of the studies.
install(FILES README.md CHANGELOG.md CONTRIBUTING.md SECURITY.md LICENSE NOTICE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT tools)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME copyright COMPONENT tools)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DATAROOTDIR}/doc/stratum-viewer RENAME copyright COMPONENT viewer)
install(DIRECTORY docs examples DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT ${with_system})
