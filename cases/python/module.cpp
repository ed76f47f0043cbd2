#include <omp.h>

#include <utility>

#include "cases/assembly/scene_motion.h"
#include "cases/keys/book.h"
#include "cases/python/bindings.h"
#include "cases/scene/version.h"
#include "fem/solve/linear_solver.h"
#include "geometry/processor_name.h"
#include "optim/optimizer.h"

namespace flexmorph::python {
namespace {

py::dict build_info() {
  py::dict libraries;
  for (const auto& [name, version] : cases::library_versions()) libraries[name.c_str()] = version;
  py::dict out;
  out["version"] = cases::kVersion;
  out["commit"] = cases::kCommit;
  out["blas_kernel"] = fem::blas_kernel();
  out["vectors"] = vector_level_name();
  out["threads"] = omp_get_max_threads();
  out["libraries"] = libraries;
  return out;
}

/// Returns name, unit and meaning of every number of a table of the result schema.
template <class Source>
py::list rows_of(std::span<const cases::ResultQuantity<Source>> quantities) {
  py::list out;
  for (const auto& each : quantities)
    out.append(py::make_tuple(each.name, each.unit, each.meaning));
  return out;
}

py::dict result_schema() {
  py::dict out;
  out["design"] = rows_of(cases::design_quantities());
  out["length_scale"] = rows_of(cases::length_scale_quantities());
  out["outline"] = rows_of(cases::outline_quantities());
  out["iteration"] = rows_of(cases::iteration_quantities());
  out["motion"] = rows_of(cases::motion_quantities());
  out["path"] = rows_of(cases::path_quantities());
  return out;
}

}  // namespace

void bind_process(py::module_& m) {
  // The package assigns its classes of exceptions, which have attributes, to these names.
  m.attr("InputError") = py::none();
  m.attr("NumericalError") = py::none();
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(std::move(thrown));
    } catch (const Error& error) {
      const py::module_ self = py::module_::import("flexmorph._core");
      const bool input = error.kind() == Error::Kind::input;
      const py::object kind = self.attr(input ? "InputError" : "NumericalError");
      PyErr_SetString(kind.is_none() ? PyExc_RuntimeError : kind.ptr(), error.what());
    } catch (const cases::StoppedMotion&) {
      PyErr_SetNone(PyExc_KeyboardInterrupt);
    } catch (const cases::Interrupted&) {
      PyErr_SetNone(PyExc_KeyboardInterrupt);
    }
  });
  m.def("build_info", &build_info);
  m.def("shipped_cases", &cases::shipped_cases);
  m.def("optimizers", &optim::optimizer_names);
  m.def("result_schema", &result_schema);
  m.def("keys", &cases::keys_for_terminal);
}

}  // namespace flexmorph::python

PYBIND11_MODULE(_core, m) {
  flexmorph::python::bind_process(m);
  flexmorph::python::bind_cases(m);
  flexmorph::python::bind_problems(m);
  flexmorph::python::bind_parts(m);
}
