# Compiles through ccache if it is installed and no other launcher is set: results of earlier
# compilations with equal options are copied, also after the build folder was emptied. GCC records
# the precompiled header of a file only with -fpch-preprocess, and ccache caches files with a
# precompiled header only with these two kinds of sloppiness; no source uses __DATE__ or __TIME__.
# Paths below the source folder are replaced by relative ones, so that clones share their results.
find_program(FLEXMORPH_CCACHE ccache)
if(FLEXMORPH_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER
      "${CMAKE_COMMAND}" -E env "CCACHE_SLOPPINESS=pch_defines,time_macros"
      "CCACHE_BASEDIR=${PROJECT_SOURCE_DIR}" "${FLEXMORPH_CCACHE}")
endif()
if(CMAKE_CXX_COMPILER_LAUNCHER MATCHES "ccache" AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  add_compile_options($<$<COMPILE_LANGUAGE:CXX>:-fpch-preprocess>)
endif()
