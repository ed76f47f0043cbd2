# Shows that floors and shelves hold: every #include of the sources points where the tables below
# allow, every included file of ours exists, and the headers of wrapped libraries stay in the .cpp
# files of their folder. Offences are named with file and line.
#
#   cmake -P tests/includes.cmake

cmake_minimum_required(VERSION 3.25)
cmake_path(GET CMAKE_CURRENT_LIST_DIR PARENT_PATH root)

# Room -> the rooms it may include besides itself. `fem` stands for the interfaces, the files
# directly in fem/, and for fem/shapes.
set(fem fem fem/model fem/elements fem/terms fem/joints fem/links fem/solve fem/triangles
        fem/dynamics fem/thermal)
set(may_geometry "")
set(may_io geometry)
set(may_fem geometry)
set(may_fem/model geometry fem)
set(may_fem/elements geometry fem)
set(may_fem/terms geometry fem)
set(may_fem/joints geometry fem)
set(may_fem/links geometry fem)
set(may_fem/solve geometry fem fem/model)
set(may_fem/triangles geometry fem fem/solve)
set(may_fem/thermal geometry fem fem/model)
set(may_fem/dynamics geometry fem fem/model fem/solve)
set(may_optim geometry)
set(may_optim/verification geometry ${fem})
set(may_optim/mmc geometry ${fem} optim optim/verification)
# The door, main.cpp, and its wings, each on top of those before it.
set(below geometry io ${fem} optim optim/verification optim/mmc)
foreach(wing scene keys assembly results output check run study)
  set(may_cases/${wing} ${below})
  list(APPEND below cases/${wing})
endforeach()
set(may_cases/accuracy ${below})
set(may_cases/stability ${below})
list(APPEND below cases/accuracy cases/stability)
set(may_cases ${below})
set(may_tests ${below} cases)

# Wrapped library (how its headers begin) -> the folder whose .cpp files may include it.
set(libraries CGAL Boost SuiteSparse VTK NLopt Ipopt toml++ CLI11 SUNDIALS valijson)
set(headers_CGAL "CGAL/")
set(headers_Boost "boost/")
set(headers_SuiteSparse "cholmod|umfpack|klu|amd|colamd|SuiteSparse|Eigen/(Cholmod|UmfPack|KLU)")
set(headers_VTK "vtk")
set(headers_NLopt "nlopt")
set(headers_Ipopt "Ip[A-Z]|coin/")
set(headers_toml++ "toml")
set(headers_CLI11 "CLI/")
set(headers_SUNDIALS "(ida|sundials|nvector|sunlinsol|sunmatrix)/")
set(headers_valijson "valijson/")
set(folder_CGAL geometry)
set(folder_Boost "geometry|fem/dynamics|optim")
set(folder_SuiteSparse fem)
set(folder_VTK io)
set(folder_NLopt optim)
set(folder_Ipopt optim)
set(folder_toml++ io)
set(folder_CLI11 cases)
set(folder_SUNDIALS tests)
set(folder_valijson tests)

# The room a file lies in.
function(room_of path room)
  if(path MATCHES "^fem/shapes/")
    set(${room} fem PARENT_SCOPE)
  elseif(path MATCHES "^(fem/[^/]+|optim/[^/]+|cases/[^/]+)/")
    set(${room} ${CMAKE_MATCH_1} PARENT_SCOPE)
  elseif(path MATCHES "^([^/]+)/")
    set(${room} ${CMAKE_MATCH_1} PARENT_SCOPE)
  else()
    set(${room} "the top" PARENT_SCOPE)
  endif()
endfunction()

# What is wrong when `file` includes the file `included` of ours, by the table; empty if nothing is.
function(judge_room file included offence)
  room_of(${file} from)
  room_of(${included} to)
  set(${offence} "" PARENT_SCOPE)
  if(NOT to IN_LIST may_${from} AND NOT to STREQUAL from)
    list(JOIN may_${from} " " allowed)
    set(${offence} "${from} may include: ${allowed}" PARENT_SCOPE)
  endif()
endfunction()

# What is wrong when `file` includes `header` of a library; empty if nothing is.
function(judge_library file header offence)
  set(${offence} "" PARENT_SCOPE)
  foreach(library ${libraries})
    if(header MATCHES "^(${headers_${library}})"
       AND NOT file MATCHES "^(tests|${folder_${library}})/.*\\.cpp$")
      set(${offence} "${library} stays in the .cpp files of ${folder_${library}}" PARENT_SCOPE)
    endif()
  endforeach()
endfunction()

# The tables must be able to refuse: known offences first, then known good ones.
foreach(pair geometry/grid.h>io/vtk.h io/vtk.cpp>fem/model/model.h fem/element.h>fem/model/model.h
             fem/terms/inertia.cpp>fem/elements/ale_ancf_plate.h fem/model/model.cpp>fem/terms/terms.h
             fem/solve/newton.cpp>fem/dynamics/esl.h optim/mma.cpp>optim/mmc/problem/design.h
             fem/thermal/heated.cpp>fem/elements/ancf_plate.h
             optim/mma.cpp>fem/model/model.h cases/run/run.h>tests/support/rate.h)
  string(REPLACE ">" ";" pair ${pair})
  judge_room(${pair} offence)
  if(NOT offence)
    message(FATAL_ERROR "the table of rooms allows: ${pair}")
  endif()
endforeach()
foreach(pair fem/terms/inertia.cpp>fem/element.h fem/dynamics/esl.cpp>fem/model/model.h
             optim/mmc/loads/compliance_evaluator.h>fem/solve/statics.h tests/fem/model_test.cpp>fem/model/model.h)
  string(REPLACE ">" ";" pair ${pair})
  judge_room(${pair} offence)
  if(offence)
    message(FATAL_ERROR "the table of rooms refuses: ${pair}")
  endif()
endforeach()
foreach(pair io/vtk.h>vtkNew.h fem/solve/newton.cpp>CGAL/Polygon_2.h
             optim/nlopt.h>nlopt.hpp fem/model/model.h>Eigen/CholmodSupport
             fem/model/model.cpp>boost/numeric/odeint.hpp
             fem/dynamics/integrators/integrator.cpp>ida/ida.h)
  string(REPLACE ">" ";" pair ${pair})
  judge_library(${pair} offence)
  if(NOT offence)
    message(FATAL_ERROR "the table of libraries allows: ${pair}")
  endif()
endforeach()

set(offences "")
set(n_includes 0)
foreach(folder geometry io fem optim cases tests)
  file(GLOB_RECURSE files RELATIVE ${root} ${root}/${folder}/*.h ${root}/${folder}/*.cpp)
  foreach(file ${files})
    file(READ ${root}/${file} text)
    string(PREPEND text "\n")
    string(REGEX MATCHALL "\n[ \t]*#[ \t]*include[ \t]*[<\"][^>\"\n]+" includes "${text}")
    foreach(include ${includes})
      string(REGEX MATCH "([<\"])(.*)$" all "${include}")
      set(included ${CMAKE_MATCH_2})
      if(CMAKE_MATCH_1 STREQUAL "<")
        judge_library(${file} ${included} offence)
      elseif(file MATCHES "^tests/examples/installed/" AND
             EXISTS ${root}/tests/examples/installed/${included})
        set(offence "")  # a project of its own, whose top that folder is
      elseif(NOT EXISTS ${root}/${included})
        set(offence "no such file, includes start at the top of the source tree")
      else()
        judge_room(${file} ${included} offence)
      endif()
      if(offence)
        string(FIND "${text}" "${include}" position)
        string(SUBSTRING "${text}" 0 ${position} before)
        string(REGEX MATCHALL "\n" line "${before}\n")
        list(LENGTH line line)
        list(APPEND offences "${file}:${line}: includes ${included}: ${offence}")
      endif()
      math(EXPR n_includes "${n_includes} + 1")
    endforeach()
  endforeach()
endforeach()

if(offences OR n_includes EQUAL 0)
  list(JOIN offences "\n  " offences)
  message(FATAL_ERROR "${n_includes} includes read\n  ${offences}")
endif()
message(STATUS "${n_includes} includes point where they may")
