# Debian packages of the components (install.cmake), made by cases/cmake/packages.sh:
# flexmorph (program), libflexmorph0.1 (library), libflexmorph-dev (development), and
# python3-flexmorph (python) where the Python package is built.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME flexmorph)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
# Who makes the packages is their maintainer: DEBFULLNAME and DEBEMAIL, as for Debian's own tools.
set(maintainer "The Flexmorph authors")
set(address flexmorph@example.org)
if(DEFINED ENV{DEBFULLNAME})
  set(maintainer $ENV{DEBFULLNAME})
endif()
if(DEFINED ENV{DEBEMAIL})
  set(address $ENV{DEBEMAIL})
endif()
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "topology optimization of flexible mechanisms")
set(CPACK_PACKAGE_CONTACT "${maintainer} <${address}>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL program library development)
if(TARGET flexmorph_python)
  list(APPEND CPACK_COMPONENTS_ALL python)
endif()
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(soversion ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})

# flexmorph_deb(<component> <name of its package> <section> <description>)
macro(flexmorph_deb component name section description)
  string(TOUPPER ${component} upper)
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${name})
  set(CPACK_DEBIAN_${upper}_PACKAGE_SECTION ${section})
  set(CPACK_DEBIAN_${upper}_DESCRIPTION "${description}")
  set(document share/doc/${name})
  configure_file(${CMAKE_CURRENT_LIST_DIR}/changelog.in ${PROJECT_BINARY_DIR}/debian/changelog
                 @ONLY)
  execute_process(COMMAND gzip -9nc ${PROJECT_BINARY_DIR}/debian/changelog
                  OUTPUT_FILE ${PROJECT_BINARY_DIR}/debian/changelog.gz)
  install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${document} RENAME copyright
          COMPONENT ${component})
  install(FILES ${PROJECT_BINARY_DIR}/debian/changelog.gz DESTINATION ${document}
          COMPONENT ${component})
endmacro()
flexmorph_deb(program flexmorph science
              "Program that simulates mechanisms with thin plates and designs the plates.")
flexmorph_deb(library libflexmorph${soversion} libs
              "Shared library for topology optimization of flexible mechanisms.")
flexmorph_deb(development libflexmorph-dev libdevel
              "Headers, static libraries, examples and files for find_package of CMake.")
if(TARGET flexmorph_python)
  flexmorph_deb(python python3-flexmorph python
                "Python package for topology optimization of flexible mechanisms.")
  # The compiled module belongs to one version of Python. The shipped cases are in flexmorph.
  string(REGEX REPLACE ".*[.]" "" minor "${FLEXMORPH_PYTHON_VERSION}")
  math(EXPR next "${minor} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
      "python3 (>= 3.${minor}), python3 (<< 3.${next}), python3-numpy, flexmorph (= ${PROJECT_VERSION})")
endif()
file(WRITE ${PROJECT_BINARY_DIR}/debian/triggers "activate-noawait ldconfig\n")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_CONTROL_EXTRA ${PROJECT_BINARY_DIR}/debian/triggers)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS
    "libflexmorph${soversion} (= ${PROJECT_VERSION}), libeigen3-dev")
# Programs that link the static libraries need the libraries of packages.txt, too.
file(STRINGS ${CMAKE_CURRENT_LIST_DIR}/packages.txt lines REGEX "^(lib|coinor-lib|nlohmann)[^ ]*-dev")
list(TRANSFORM lines REPLACE " .*" "")
list(REMOVE_ITEM lines libeigen3-dev)  # is among the dependencies
list(APPEND lines pkgconf)
list(JOIN lines ", " CPACK_DEBIAN_DEVELOPMENT_PACKAGE_RECOMMENDS)
include(CPack)
