# The target `documentation` makes HTML pages of the public headers in build/documentation/html. The
# main page is cases/docs/extending.md without its links to other documents. The target exists where
# Doxygen is installed. A warning of Doxygen is an error.
find_package(Doxygen QUIET)
if(NOT DOXYGEN_FOUND)
  return()
endif()
set(DOXYGEN_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/documentation)
set(DOXYGEN_PROJECT_BRIEF "${PROJECT_DESCRIPTION}")
set(DOXYGEN_STRIP_FROM_PATH ${PROJECT_SOURCE_DIR})
set(DOXYGEN_FULL_PATH_NAMES YES)
set(DOXYGEN_USE_MDFILE_AS_MAINPAGE ${PROJECT_SOURCE_DIR}/cases/docs/extending.md)
set(DOXYGEN_FILTER_PATTERNS "*.md=sed -E -f ${CMAKE_CURRENT_LIST_DIR}/plain_links.sed")
set(DOXYGEN_JAVADOC_AUTOBRIEF YES)      # the first sentence is the brief description
set(DOXYGEN_DISTRIBUTE_GROUP_DOC YES)
set(DOXYGEN_MARKDOWN_SUPPORT YES)
set(DOXYGEN_TOC_INCLUDE_HEADINGS 3)
set(DOXYGEN_EXTRACT_STATIC YES)
set(DOXYGEN_HIDE_UNDOC_MEMBERS NO)
# tests/declarations.py finds declarations without a comment; overriding functions have that of the
# base class, and not every parameter needs a sentence.
set(DOXYGEN_WARN_IF_UNDOCUMENTED NO)
set(DOXYGEN_WARN_NO_PARAMDOC NO)
set(DOXYGEN_WARN_AS_ERROR FAIL_ON_WARNINGS)
set(DOXYGEN_GENERATE_LATEX NO)
set(DOXYGEN_HAVE_DOT NO)
set(DOXYGEN_WARN_IF_INCOMPLETE_DOC NO)
set(DOXYGEN_EXCLUDE_SYMBOLS "Impl" "*::Impl")
file(STRINGS ${CMAKE_CURRENT_LIST_DIR}/public_headers.txt documented REGEX "^[^#]")
list(APPEND documented cases/docs/extending.md)
list(TRANSFORM documented PREPEND ${PROJECT_SOURCE_DIR}/)
doxygen_add_docs(documentation ${documented} WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}
                 COMMENT "Doxygen: build/documentation/html/index.html")
