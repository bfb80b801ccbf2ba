# `cpack` makes Debian packages: stratum (the tools), stratum-viewer (vdbview), libstratum-dev (the static libraries and
# their headers), and python3-stratum (the Python module).
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME stratum)
set(CPACK_PACKAGE_CONTACT "The Stratum developers <stratum@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "printer G-code to OpenVDB level sets to ray-traced pictures")
set(CPACK_STRIP_FILES ON)
if(STRATUM_BUNDLE)
  set(CPACK_GENERATOR TGZ)
  set(CPACK_COMPONENTS_ALL tools viewer bundle)
  set(CPACK_ARCHIVE_COMPONENT_INSTALL ON)
  set(CPACK_COMPONENTS_GROUPING ALL_COMPONENTS_IN_ONE)
  set(CPACK_PACKAGE_FILE_NAME stratum-${PROJECT_VERSION}-${CMAKE_SYSTEM_NAME}-${CMAKE_SYSTEM_PROCESSOR})
  set(CPACK_COMPONENT_INCLUDE_TOPLEVEL_DIRECTORY ON)
  include(CPack)
  return()
endif()

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_COMPONENTS_ALL tools viewer dev)
if(STRATUM_PYTHON)
  list(APPEND CPACK_COMPONENTS_ALL python)
endif()
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)

set(CPACK_DEBIAN_TOOLS_PACKAGE_NAME stratum)
set(CPACK_DEBIAN_TOOLS_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_TOOLS_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_TOOLS_PACKAGE_SUGGESTS "blender, ffmpeg, python3-numpy")
set(CPACK_COMPONENT_TOOLS_DESCRIPTION
  "gcode2vdb turns the G-code of a slicer into a level set of the part as printed,
vdbtrace ray-traces it, vdbstudy measures both. With an add-on for Blender.")

# The tables of materials and the documents are in the package of the tools.
set(CPACK_DEBIAN_VIEWER_PACKAGE_NAME stratum-viewer)
set(CPACK_DEBIAN_VIEWER_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_VIEWER_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_VIEWER_PACKAGE_DEPENDS "stratum (= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_VIEWER_PACKAGE_SUGGESTS "www-browser")
set(CPACK_COMPONENT_VIEWER_DESCRIPTION
  "vdbview shows prints, level sets and scenes in a browser: layers, sections, the line of G-code under a click.")

set(CPACK_DEBIAN_DEV_PACKAGE_NAME libstratum-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "libopenvdb-dev, libboost-dev, libboost-iostreams-dev, libtbb-dev, libblosc-dev, liblz4-dev, \
libopenexr-dev, libglm-dev, libpng-dev, libssl-dev, libfmt-dev, nlohmann-json3-dev, libfast-float-dev, libassimp-dev, \
libhwy-dev, libdeflate-dev, libjpeg62-turbo-dev, libwebp-dev, zlib1g-dev, libzip-dev, pkg-config")
set(CPACK_COMPONENT_DEV_DESCRIPTION
  "The libraries behind the tools: find_package(stratum) gives stratum::gcode, stratum::voxelize, stratum::march
and stratum::shade.")

# A module is for one minor version of the interpreter.
set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-stratum)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
if(STRATUM_PYTHON)
  math(EXPR next_python "${Python_VERSION_MINOR} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
    "python3 (>= 3.${Python_VERSION_MINOR}~), python3 (<< 3.${next_python}), python3-numpy, stratum (= ${PROJECT_VERSION})")
endif()
set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "python3-openvdb")
set(CPACK_COMPONENT_PYTHON_DESCRIPTION
  "import stratum: toolpaths of G-code as NumPy arrays, level sets, distances, rays and pictures.")
include(CPack)
