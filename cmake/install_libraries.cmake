# The libraries for other projects, by add_subdirectory or installed and found by find_package(stratum): each room of src/
# as stratum::ROOM.
include(CMakePackageConfigHelpers)

set(rooms base vdb gcode motion deposit voxelize export report compare mechanics trace march ondemand shade assemble animate)
foreach(room ${rooms})
  add_library(stratum::${room} ALIAS stratum_${room})
  set_target_properties(stratum_${room} PROPERTIES EXPORT_NAME ${room})
  list(APPEND targets stratum_${room})
endforeach()
set_target_properties(stratum_options PROPERTIES EXPORT_NAME options)
install(TARGETS stratum_options ${targets} EXPORT stratum
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT dev)
foreach(room ${rooms})
  # Not the -inl.h: they are parts of .cpp files.
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/src/${room} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/stratum COMPONENT dev
    FILES_MATCHING PATTERN "*.h" PATTERN "*-inl.h" EXCLUDE)
endforeach()
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/stratum)
install(EXPORT stratum NAMESPACE stratum:: FILE stratumTargets.cmake DESTINATION ${package_dir} COMPONENT dev)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/stratumConfig.cmake.in
  ${PROJECT_BINARY_DIR}/stratumConfig.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/stratumConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/stratumConfig.cmake ${PROJECT_BINARY_DIR}/stratumConfigVersion.cmake
  DESTINATION ${package_dir} COMPONENT dev)
