# What `cmake --install --component ...` puts where.
# program: flexmorph and, in share/flexmorph/cases, where it looks for them, shipped cases.
# development: static libraries, headers under include/flexmorph (included as here: "fem/model/model.h"),
# and what find_package(Flexmorph) reads.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(flexmorph_package "${CMAKE_INSTALL_LIBDIR}/cmake/Flexmorph")

install(TARGETS flexmorph RUNTIME COMPONENT program)
file(GLOB flexmorph_shipped CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/cases/*.toml
                                              ${PROJECT_SOURCE_DIR}/cases/*.csv)
install(FILES ${flexmorph_shipped} DESTINATION share/flexmorph/cases COMPONENT program)

set(flexmorph_libraries options geometry io fem thermal optim verification mmc)
foreach(library ${flexmorph_libraries})
  set_target_properties(flexmorph_${library} PROPERTIES EXPORT_NAME ${library})
endforeach()
list(TRANSFORM flexmorph_libraries PREPEND flexmorph_)
install(TARGETS ${flexmorph_libraries} EXPORT Flexmorph ARCHIVE COMPONENT development)
install(EXPORT Flexmorph NAMESPACE flexmorph:: DESTINATION ${flexmorph_package}
        COMPONENT development)
foreach(folder geometry io fem optim)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/${folder} COMPONENT development
          DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/flexmorph
          FILES_MATCHING PATTERN "*.h" PATTERN precompiled.h EXCLUDE
          PATTERN eigen_instances.h EXCLUDE PATTERN geos.h EXCLUDE)
endforeach()

write_basic_package_version_file(${PROJECT_BINARY_DIR}/FlexmorphConfigVersion.cmake
                                 COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_LIST_DIR}/FlexmorphConfig.cmake
              ${CMAKE_CURRENT_LIST_DIR}/dependencies.cmake
              ${CMAKE_CURRENT_LIST_DIR}/packages.txt
              ${PROJECT_BINARY_DIR}/FlexmorphConfigVersion.cmake
        DESTINATION ${flexmorph_package} COMPONENT development)
