# Headers that nearly every file includes are parsed once, geometry/precompiled.h: half of the time of
# a small file went into them. A copy serves all targets that are compiled with the same options;
# GCC refuses it silently where they differ.

# flexmorph_precompile(<target> [<more headers>...]): a copy for this target alone.
function(flexmorph_precompile target)
  target_precompile_headers(${target} PRIVATE "${PROJECT_SOURCE_DIR}/geometry/precompiled.h" ${ARGN})
endfunction()

# flexmorph_precompiled(<name> <library>...): a target that holds a copy for others, which say
# target_precompile_headers(<target> REUSE_FROM <name>).
function(flexmorph_precompiled name)
  set(source "${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp")
  file(CONFIGURE OUTPUT "${source}" CONTENT "// holds the precompiled header\n")
  add_library(${name} OBJECT "${source}")
  target_link_libraries(${name} PRIVATE ${ARGN})
  flexmorph_precompile(${name})
endfunction()
