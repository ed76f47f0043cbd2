# Headers that nearly every file includes, geometry/precompiled.h, are parsed only once; otherwise
# they take half of the compile time of a small file. One copy serves all targets with equal compile
# options; GCC refuses it silently if they differ.

# flexmorph_precompile(<target> [<more headers>...]): a copy for this target only.
function(flexmorph_precompile target)
  target_precompile_headers(${target} PRIVATE "${PROJECT_SOURCE_DIR}/geometry/precompiled.h" ${ARGN})
endfunction()

# flexmorph_precompiled(<name> <library>...): a target that holds a copy for other targets, which
# use it by target_precompile_headers(<target> REUSE_FROM <name>).
function(flexmorph_precompiled name)
  set(source "${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp")
  file(CONFIGURE OUTPUT "${source}" CONTENT "// holds the precompiled header\n")
  add_library(${name} OBJECT "${source}")
  target_link_libraries(${name} PRIVATE ${ARGN})
  flexmorph_precompile(${name})
endfunction()
