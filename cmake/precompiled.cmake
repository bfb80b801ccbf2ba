# Headers that are parsed once: OpenVDB's alone take longer to parse than most files of this project to compile. Each
# list is a library of its own, whose result others reuse, so that it is made once a build and not once a room.
# Sources name what they use all the same: CMAKE_DISABLE_PRECOMPILE_HEADERS=ON builds without, and the linter does.
function(stratum_precompiled name)
  cmake_parse_arguments(arg "" "" "HEADERS;LIBRARIES" ${ARGN})
  add_library(${name} OBJECT EXCLUDE_FROM_ALL ${PROJECT_SOURCE_DIR}/cmake/precompiled/empty.cpp)
  target_link_libraries(${name} PRIVATE stratum_options ${arg_LIBRARIES})
  target_precompile_headers(${name} PRIVATE ${arg_HEADERS})
endfunction()

# OpenVDB; what is built with it links stratum_vdb, which has the trees that this header only declares.
set(trees ${PROJECT_SOURCE_DIR}/src/vdb/tree_instances.h)
stratum_precompiled(precompiled_openvdb HEADERS ${trees} LIBRARIES OpenVDB::openvdb)
if(STRATUM_TOOLS)
  stratum_precompiled(precompiled_command_line HEADERS <CLI/CLI.hpp> <nlohmann/json.hpp>
    LIBRARIES CLI11::CLI11 nlohmann_json::nlohmann_json)
  stratum_precompiled(precompiled_tools HEADERS <CLI/CLI.hpp> <nlohmann/json.hpp> ${trees}
    LIBRARIES OpenVDB::openvdb CLI11::CLI11 nlohmann_json::nlohmann_json)
endif()
if(STRATUM_TESTS)
  find_package(GTest REQUIRED)
  stratum_precompiled(precompiled_tests HEADERS <gtest/gtest.h> LIBRARIES GTest::gtest)
  stratum_precompiled(precompiled_openvdb_tests HEADERS <gtest/gtest.h> ${trees}
    LIBRARIES GTest::gtest OpenVDB::openvdb)
endif()
