# Where things go in a wheel (scikit-build-core): the tools among the scripts of the environment, what they read below its
# prefix, where src/shade/data_folder.cpp looks for it.
set(CMAKE_INSTALL_BINDIR ${SKBUILD_SCRIPTS_DIR})
set(CMAKE_INSTALL_DATAROOTDIR ${SKBUILD_DATA_DIR}/share)
set(CMAKE_INSTALL_DATADIR ${SKBUILD_DATA_DIR}/share)
set(CMAKE_INSTALL_MANDIR ${SKBUILD_DATA_DIR}/share/man)
set(CMAKE_INSTALL_DOCDIR ${SKBUILD_DATA_DIR}/share/doc/stratum)
