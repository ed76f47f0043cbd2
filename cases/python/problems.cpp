#include <cstring>
#include <deque>
#include <thread>

#include "cases/python/bindings.h"
#include "cases/results/schema.h"
#include "cases/run/design_problem.h"
#include "optim/cancellable_problem.h"
#include "optim/mmc/cycles/usability.h"

namespace flexmorph::python {
namespace {

using Options = std::map<std::string, double>;

/// A design problem with the values of its last designs.
class Problem {
 public:
  Problem(Case of, const std::string& body, const std::string& stage, bool of_motion, double cell,
          double step)
      : case_(std::move(of)) {
    cases::DesignProblemSettings settings{body, stage_of(stage),   of_motion, cell,
                                          step, callback_of(flag_)};
    run([&] { of_.emplace(case_.prepared(), settings); });
  }
  Problem(const Problem& other, cases::DesignProblem of)
      : case_(other.case_), flag_(other.flag_), of_(std::move(of)) {}

  Problem at(const std::string& stage, const VectorXd& x) {
    std::optional<cases::DesignProblem> out;
    run([&] { out.emplace(of_->at(stage_of(stage), x)); });
    return {*this, std::move(*out)};
  }

  cases::DesignProblem& problem() { return *of_; }
  optim::Problem& functions() { return of_->problem(); }

  /// Returns the values and gradients at x, from the cache where possible.
  const optim::ProblemValues& values(const VectorXd& x) {
    if (x.size() != functions().n_variables())
      throw py::value_error("x has the shape (" + std::to_string(functions().n_variables()) + ",)");
    for (const Entry& each : known_)
      if (std::memcmp(each.x.data(), x.data(), sizeof(double) * static_cast<size_t>(x.size())) == 0)
        return each.values;
    optim::ProblemValues found;
    run([&] { found = of_->evaluate(x); });
    ++evaluations_;
    constexpr size_t kKept = 4;
    if (known_.size() == kKept) known_.pop_back();
    known_.push_front({x, std::move(found)});
    return known_.front().values;
  }
  py::tuple evaluate(const VectorXd& x) {
    const optim::ProblemValues& r = values(x);
    return py::make_tuple(r.f, r.df, r.g, r.dg);
  }
  MatrixXd hessian(const VectorXd& x, const VectorXd& lambda, double factor) {
    MatrixXd out;
    run([&] { out = functions().curvature(x, factor, lambda); });
    return out;
  }
  bool acceptable(const VectorXd& x) {
    values(x);
    bool out = false;
    run([&] {
      functions().evaluate(x);
      out = functions().acceptable(x);
    });
    return out;
  }
  int evaluations() const { return evaluations_; }
  const Case& of_case() const { return case_; }

  py::list crisp(const VectorXd& x) {
    std::vector<mmc::CrispDesign> found;
    run([&] { found = of_->crisp(x); });
    py::list out;
    const std::vector<double> violations = of_->crisp_violations(found);
    for (size_t b = 0; b < found.size(); ++b) {
      const mmc::CrispDesign& c = found[b];
      py::dict each;
      each["crisp_violation"] = violations[b];
      each["compliance"] = c.compliance;
      each["volume"] = c.volume;
      each["connected"] = c.connectivity.connected;
      if (c.features) {
        each["min_feature"] = c.features->solid;
        each["min_gap"] = c.features->gap;
      }
      for (const auto& [name, value] : c.further) each[name.c_str()] = value;
      out.append(each);
    }
    return out;
  }
  py::dict components(const VectorXd& x) {
    py::dict out;
    const std::vector<std::string> bodies = of_->bodies();
    const std::vector<std::vector<Component>> all = of_->components(x);
    for (size_t b = 0; b < all.size(); ++b) out[bodies[b].c_str()] = array_of(all[b]);
    return out;
  }

  /// Minimizes the problem itself, and returns its result.
  py::dict minimize(const std::string& name, const Options& options, const py::object& callback) {
    const optim::Settings settings = settings_of(name, options);
    optim::Result found;
    const Callback call(callback);
    const optim::Observer observe = [&](const optim::Iterate& it) { return see(it, call); };
    optim::CancellableProblem problem(functions(), [this] { return flag_.keeps_running(); });
    run([&] { found = optim::make_optimizer(settings)->minimize(problem, observe); });
    py::dict out;
    out["x"] = found.x;
    out["fun"] = found.response.f;
    out["constraints"] = found.response.g;
    out["kkt"] = found.kkt;
    out["violation"] = found.violation;
    out["nit"] = found.iterations;
    out["nfev"] = found.evaluations;
    out["status"] = to_string(found.stop);
    out["message"] = found.message;
    out["success"] = found.violation <= settings.feasibility && found.stop != optim::Stop::failed;
    return out;
  }

  /// Designs the bodies through all stages of a cycle, and returns numbers and components.
  py::dict design(const std::string& name, const Options& options, const py::object& callback) {
    const optim::Settings settings = settings_of(name, options);
    const auto observer = observer_of(callback, case_.prepared().scene(), flag_);
    std::vector<mmc::BodyProblem> designed;
    std::vector<mmc::BodyOutcome> outcomes;
    run([&] {
      outcomes = of_->design(
          settings,
          [&](const mmc::IterationReport& r) {
            if (observer) observer(r);
            return flag_.keeps_running();
          },
          designed);
    });
    py::dict out;
    for (size_t b = 0; b < outcomes.size(); ++b) {
      py::dict numbers;
      for (const auto& quantity : cases::design_quantities())
        numbers[quantity.name] = object_of(quantity.value(outcomes[b]));
      numbers["crisp_violation"] = mmc::crisp_violation(designed[b], outcomes[b].crisp);
      out[designed[b].body.c_str()] =
          py::make_tuple(array_of(designed[b].design.components()), numbers);
    }
    return out;
  }

 private:
  /// The thread that computes with the problem; no thread if nothing is computed.
  struct Use {
    std::atomic<std::thread::id> worker;
  };
  struct Entry {
    VectorXd x;
    optim::ProblemValues values;
  };

  static cases::DesignStage stage_of(const std::string& name) {
    if (name == "coarse") return cases::DesignStage::coarse;
    if (name == "eroded") return cases::DesignStage::eroded;
    if (name == "last") return cases::DesignStage::last;
    throw Error::input("stage '" + name + "' is unknown; the stages are: coarse, eroded, last");
  }
  void run(const std::function<void()>& work) {
    Use& use = *use_;
    const std::thread::id before = use.worker, me = std::this_thread::get_id();
    // A callback of a computation may compute; another thread may not.
    if (before != std::thread::id() && before != me)
      throw Error::input("another thread computes with this problem; every thread needs its own");
    if (before == std::thread::id()) flag_.reset();
    use.worker = me;
    try {
      compute_in_thread(
          [&] {
            use.worker = std::this_thread::get_id();
            work();
          },
          case_.threads, flag_);
    } catch (...) {
      use.worker = before;
      throw;
    }
    use.worker = before;
  }
  optim::Settings settings_of(const std::string& name, const Options& options) const {
    optim::Settings out = case_.prepared().scene().optimizer;
    if (!name.empty() && name != out.name) {
      out.name = name;
      out.options.clear();
    }
    for (const auto& [key, value] : options) {
      if (key == "max_iterations")
        out.max_iterations = static_cast<int>(value);
      else if (key == "max_evaluations")
        out.max_evaluations = static_cast<int>(value);
      else if (key == "kkt_tolerance")
        out.kkt_tolerance = value;
      else if (key == "change_tolerance")
        out.change_tolerance = value;
      else if (key == "move_limit")
        out.move_limit = value;
      else
        out.options[key] = value;
    }
    return out;
  }
  bool see(const optim::Iterate& it, const Callback& call) const {
    if (call) {
      const py::gil_scoped_acquire acquire;
      py::dict row;
      row["iteration"] = it.iteration;
      row["evaluations"] = it.evaluations;
      row["x"] = VectorXd(*it.x);
      row["fun"] = it.response->f;
      row["constraints"] = VectorXd(it.response->g);
      row["kkt"] = it.kkt;
      row["violation"] = it.violation;
      row["change"] = it.change;
      // The flag is not set, because the best design is evaluated once more at the end.
      if (call.get()(row).ptr() == Py_True) return false;
    }
    return flag_.keeps_running();
  }

  Case case_;
  StopFlag flag_;
  std::unique_ptr<Use> use_ = std::make_unique<Use>();
  std::optional<cases::DesignProblem> of_;
  std::deque<Entry> known_;
  int evaluations_ = 0;
};

}  // namespace

void bind_problems(py::module_& m) {
  py::class_<Problem>(m, "Problem")
      .def(py::init<Case, const std::string&, const std::string&, bool, double, double>())
      .def("at", &Problem::at)
      .def_property_readonly("n", [](Problem& p) { return p.functions().n_variables(); })
      .def_property_readonly("m", [](Problem& p) { return p.functions().n_constraints(); })
      .def_property_readonly("x0", [](Problem& p) { return p.functions().start(); })
      .def_property_readonly("lower", [](Problem& p) { return p.functions().lower(); })
      .def_property_readonly("upper", [](Problem& p) { return p.functions().upper(); })
      .def_property_readonly("names", [](Problem& p) { return p.problem().variable_names(); })
      .def_property_readonly("constraint_names",
                             [](Problem& p) { return p.problem().constraint_names(); })
      .def_property_readonly("bodies", [](Problem& p) { return p.problem().bodies(); })
      .def_property_readonly("has_hessian",
                             [](Problem& p) { return p.functions().has_curvature(); })
      .def_property_readonly("evaluations", &Problem::evaluations)
      .def("evaluate", &Problem::evaluate)
      .def("acceptable", &Problem::acceptable)
      .def("hessian", &Problem::hessian)
      .def("crisp", &Problem::crisp)
      .def("components", &Problem::components)
      .def("minimize", &Problem::minimize)
      .def("design", &Problem::design);
}

}  // namespace flexmorph::python
