# Components of `cmake --install --component ...`:
# program: flexmorph and the shipped cases, in share/flexmorph/cases, where it searches for them.
# python: the Python package, if it was built.
# library: the shared library, which contains all of Flexmorph.
# development: the static libraries, the files for linking the shared one, public headers under
# include/flexmorph (included as in this tree: "fem/model/model.h"), examples, and the files for
# find_package(Flexmorph).
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(flexmorph_package "${CMAKE_INSTALL_LIBDIR}/cmake/Flexmorph")

install(TARGETS flexmorph RUNTIME COMPONENT program)
file(GLOB flexmorph_shipped CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/cases/*.toml
                                              ${PROJECT_SOURCE_DIR}/cases/*.csv)
install(FILES ${flexmorph_shipped} DESTINATION share/flexmorph/cases COMPONENT program)
# Templates of `flexmorph new`.
file(GLOB flexmorph_templates CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/cases/templates/*.toml)
install(FILES ${flexmorph_templates} DESTINATION share/flexmorph/cases/templates COMPONENT program)

# Manual pages and completion of shells, printed by the program.
set(shell ${PROJECT_BINARY_DIR}/shell)
file(MAKE_DIRECTORY ${shell})
set(script "\"$1\" manual 1 | gzip -9n >flexmorph.1.gz && \"$1\" manual 5 | gzip -9n >flexmorph.5.gz && \
\"$1\" completion bash >flexmorph && \"$1\" completion zsh >_flexmorph")
add_custom_command(
  OUTPUT ${shell}/flexmorph.1.gz ${shell}/flexmorph.5.gz ${shell}/flexmorph ${shell}/_flexmorph
  COMMAND sh -ec "${script}" sh $<TARGET_FILE:flexmorph>
  DEPENDS flexmorph
  WORKING_DIRECTORY ${shell}
  COMMENT "Printing manual pages and completion" VERBATIM)
add_custom_target(flexmorph_shell ALL DEPENDS ${shell}/flexmorph.1.gz)
foreach(section 1 5)
  install(FILES ${shell}/flexmorph.${section}.gz DESTINATION ${CMAKE_INSTALL_MANDIR}/man${section}
          COMPONENT program)
endforeach()
install(FILES ${shell}/flexmorph DESTINATION share/bash-completion/completions COMPONENT program)
install(FILES ${shell}/_flexmorph DESTINATION share/zsh/vendor-completions COMPONENT program)

set(flexmorph_static geometry io fem thermal optim verification mmc cases)
foreach(library options ${flexmorph_static})
  set_target_properties(flexmorph_${library} PROPERTIES EXPORT_NAME ${library})
endforeach()
list(TRANSFORM flexmorph_static PREPEND flexmorph_)

if(TARGET flexmorph_python)
  set(FLEXMORPH_PYTHON_DIR "lib/python${FLEXMORPH_PYTHON_VERSION}/dist-packages" CACHE STRING
      "folder of the Python package below the prefix")
  install(TARGETS flexmorph_python LIBRARY COMPONENT python
          DESTINATION ${FLEXMORPH_PYTHON_DIR}/flexmorph)
  install(FILES ${flexmorph_python_sources}
                ${PROJECT_BINARY_DIR}/python/flexmorph/__init__.pyi COMPONENT python
          DESTINATION ${FLEXMORPH_PYTHON_DIR}/flexmorph)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/cases/python/examples COMPONENT python
          DESTINATION share/doc/python3-flexmorph PATTERN __pycache__ EXCLUDE)
endif()

# The shared library is linked from the objects of the static ones. Programs that use it need no
# library but Eigen's headers.
list(TRANSFORM flexmorph_static REPLACE "(.+)" "$<TARGET_OBJECTS:\\1>" OUTPUT_VARIABLE objects)
add_library(flexmorph_shared SHARED ${objects})
add_library(flexmorph::flexmorph ALIAS flexmorph_shared)
target_link_libraries(flexmorph_shared PUBLIC flexmorph::options Eigen3::Eigen
                      PRIVATE $<BUILD_INTERFACE:flexmorph_cases>)
set_target_properties(
  flexmorph_shared PROPERTIES OUTPUT_NAME flexmorph EXPORT_NAME flexmorph LINKER_LANGUAGE CXX
  VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})

install(TARGETS flexmorph_options ${flexmorph_static} EXPORT FlexmorphStatic
        ARCHIVE COMPONENT development)
install(TARGETS flexmorph_options flexmorph_shared EXPORT FlexmorphShared
        LIBRARY COMPONENT library NAMELINK_COMPONENT development)
foreach(kind Static Shared)
  install(EXPORT Flexmorph${kind} NAMESPACE flexmorph:: DESTINATION ${flexmorph_package}
          COMPONENT development)
endforeach()
file(STRINGS "${CMAKE_CURRENT_LIST_DIR}/public_headers.txt" flexmorph_headers REGEX "^[^#]")
foreach(header ${flexmorph_headers})
  cmake_path(GET header PARENT_PATH folder)
  install(FILES "${PROJECT_SOURCE_DIR}/${header}" COMPONENT development
          DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/flexmorph/${folder}")
endforeach()
install(DIRECTORY "${PROJECT_SOURCE_DIR}/cases/examples" DESTINATION share/flexmorph
        COMPONENT development)

write_basic_package_version_file(${PROJECT_BINARY_DIR}/FlexmorphConfigVersion.cmake
                                 COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_LIST_DIR}/FlexmorphConfig.cmake
              ${CMAKE_CURRENT_LIST_DIR}/dependencies.cmake
              ${CMAKE_CURRENT_LIST_DIR}/packages.txt
              ${PROJECT_BINARY_DIR}/FlexmorphConfigVersion.cmake
        DESTINATION ${flexmorph_package} COMPONENT development)
