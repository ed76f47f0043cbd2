#pragma once

#include <pybind11/eigen.h>
#include <pybind11/functional.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <memory>

#include "cases/python/computation.h"
#include "cases/results/schema.h"
#include "cases/run/compute.h"
#include "geometry/components/component.h"
#include "geometry/grid.h"

/// The extension module flexmorph._core, in parts. The package flexmorph uses it; users do not.
namespace flexmorph::python {

/// A case of the package: the case, and the number of threads of its computations.
struct Case {
  std::shared_ptr<const cases::ReadyCase> ready;  ///< Case with its file.
  int threads = 1;                                ///< Number of threads of computations.

  /// Returns the prepared case.
  const cases::PreparedCase& prepared() const { return ready->prepared; }
};

/// Adds the exceptions and the functions of the process to the module.
void bind_process(py::module_& m);
/// Adds the cases and their computations to the module.
void bind_cases(py::module_& m);
/// Adds the design problems to the module.
void bind_problems(py::module_& m);
/// Adds the registration of responses, drives, force elements and optimizers to the module.
void bind_parts(py::module_& m);

/// Returns a field of the cells (n_cells) as an array (ny x nx), with y upwards.
py::array_t<double> on_grid(const Grid& grid, const VectorXd& field);
/// Returns the field of the cells (n_cells) of an array (ny x nx).
/// @throws py::value_error for another shape
VectorXd from_grid(const Grid& grid, const py::object& array);
/// Returns a value of a result; None if it is absent or unknown.
py::object object_of(const cases::Value& value);
/// Returns components as an array (N x 7) in the order of Component::parameters().
py::array_t<double> array_of(const std::vector<Component>& components);
/// Returns the components of an array (N x 7).
/// @throws py::value_error for another shape
std::vector<Component> components_of(
    const py::array_t<double, py::array::c_style | py::array::forcecast>& array);
/// Returns the results of a run as a dictionary: the text of run.json, the tables, and the
/// components of the designs.
py::dict dict_of(const cases::Scene& scene, const cases::RunResult& result);
/// Returns a table as a dictionary: names, units, meanings, and values (n_rows x n_columns).
py::dict dict_of(const cases::Series& table);
/// Returns the values of a design iteration by their names in history.csv, and the variables x.
py::dict dict_of(const cases::Scene& scene, const mmc::IterationReport& report);

/// Returns an observer of design iterations that calls a function of Python with dict_of() each;
/// if the function returns True, the flag is set.
std::function<void(const mmc::IterationReport&)> observer_of(const py::object& function,
                                                             const cases::Scene& scene,
                                                             const StopFlag& flag);

}  // namespace flexmorph::python
