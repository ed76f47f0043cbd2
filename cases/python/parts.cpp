#include <algorithm>
#include <cstring>
#include <deque>

#include "cases/python/bindings.h"
#include "cases/scene/drive.h"
#include "cases/scene/spring.h"
#include "fem/force_elements/pair_force_element.h"
#include "optim/makers.h"
#include "optim/mmc/problem/response.h"
#include "optim/search.h"

namespace flexmorph::python {
namespace {

/// Functions of Python that rows of the tables call, by their names. Rows cannot be removed;
/// adding a name again replaces its function.
class Functions {
 public:
  /// Stores a function. @return true if the name is new
  bool put(const std::string& name, const py::object& function) {
    const bool is_new = !functions_.contains(name);
    functions_[name] = Callback(function);
    return is_new;
  }
  /// Returns the present function of a name.
  Callback at(const std::string& name) const { return functions_.at(name); }

 private:
  std::map<std::string, Callback> functions_;
};

/// Returns an object that exists until the process ends, as rows of tables must.
template <class T>
T& kept(T value) {
  static auto& all = *new std::deque<T>;
  return all.emplace_back(std::move(value));
}

// --- responses

/// A response that a function of Python computes from all cells at once.
class PythonResponse final : public mmc::Response {
 public:
  PythonResponse(const mmc::Plate& plate, Callback function)
      : plate_(plate), function_(std::move(function)) {}

  void evaluate(const mmc::DesignView& at, mmc::Values& out) override {
    const py::gil_scoped_acquire acquire;
    const Grid& g = plate_.grid;
    const Eigen::Index n = g.n_cells();
    VectorXd x(n), y(n);
    for (int i = 0; i < g.nx; ++i)
      for (int j = 0; j < g.ny; ++j) {
        x[g.cell(i, j)] = g.cell_center(i, j).x();
        y[g.cell(i, j)] = g.cell_center(i, j).y();
      }
    const py::object cells =
        py::module_::import("flexmorph._parts")
            .attr("Cells")(on_grid(g, x), on_grid(g, y), on_grid(g, at.factors.mass),
                           on_grid(g, at.factors.stiffness), g.dx() * g.dy(),
                           plate_.section.thickness, plate_.section.density,
                           array_of({at.components.begin(), at.components.end()}));
    const py::tuple answer = function_.get()(cells);
    if (answer.size() != 2) throw py::value_error("a response returns (value, gradients)");
    const py::dict gradients = answer[1];
    out.f = VectorXd::Constant(1, answer[0].cast<double>());
    const auto row = [&](const char* name) {
      MatrixXd gradient = MatrixXd::Zero(1, n);
      if (gradients.contains(name)) gradient.row(0) = from_grid(g, gradients[name]).transpose();
      return gradient;
    };
    for (const auto& [name, value] : gradients)
      if (const auto key = name.cast<std::string>(); key != "mass" && key != "stiffness")
        throw py::value_error("gradients of a response are by 'mass' and 'stiffness', not by '" +
                              key + "'");
    out.d_mass = row("mass");
    out.d_stiffness = row("stiffness");
  }

 private:
  mmc::Plate plate_;
  Callback function_;
};

void add_response(const std::string& name, const py::object& function, const std::string& unit,
                  const std::string& words, bool linear) {
  static Functions& all = kept(Functions());
  if (!all.put(name, function)) return;
  const std::string& own = kept(name);
  mmc::ResponseRow row{.name = own, .words = kept(words), .unit = kept(unit), .linear = linear};
  row.make = [&own](const mmc::Plate& plate) -> std::unique_ptr<mmc::Response> {
    return std::make_unique<PythonResponse>(plate, all.at(own));
  };
  mmc::register_response(kept(row));
}

// --- drives

void add_drive(const std::string& name, const py::object& function, const std::string& sentence) {
  static Functions& all = kept(Functions());
  if (!all.put(name, function)) return;
  cases::register_drive(kept(
      cases::DriveRow{name, sentence, [name](double t) {
                        const py::gil_scoped_acquire acquire;
                        const auto values = all.at(name).get()(t).cast<std::array<double, 3>>();
                        return fem::Motion{values[0], values[1], values[2]};
                      }}));
}

// --- force elements

/// A force between two points that a function of Python computes from their relative motion.
class PythonForce final : public fem::PairForceElement {
 public:
  PythonForce(std::string name, const fem::MarkerLocation& a, const fem::MarkerLocation& b,
              Callback function)
      : PairForceElement(std::move(name), a, b, {Part::kPositionA, Part::kPositionB}, true),
        function_(std::move(function)) {}
  std::unique_ptr<ForceElement> clone() const override {
    return std::make_unique<PythonForce>(*this);
  }

 protected:
  void fill(const fem::State& x, const Values& y, const Values& rate,
            fem::PairForce& out) const override {
    const Vec2 r = y.segment<2>(Part::kPositionB) - y.segment<2>(Part::kPositionA),
               v = rate.segment<2>(Part::kPositionB) - rate.segment<2>(Part::kPositionA);
    const py::gil_scoped_acquire acquire;
    const py::tuple answer = function_.get()(r, v, x.t);
    if (answer.size() != 3)
      throw py::value_error("a force element returns (force, d_force/d_r, d_force/d_v)");
    const auto force = answer[0].cast<Vec2>();
    const auto by_r = answer[1].cast<Eigen::Matrix2d>(), by_v = answer[2].cast<Eigen::Matrix2d>();
    // s is on the left side of the equations of motion, the force on the right side.
    for (const auto& [part, sign] : {std::pair{Part::kPositionA, 1.0}, {Part::kPositionB, -1.0}}) {
      out.s.segment<2>(part) = sign * force;
      out.s_y.block<2, 2>(part, Part::kPositionB) = sign * by_r;
      out.s_y.block<2, 2>(part, Part::kPositionA) = -sign * by_r;
      out.s_rate.block<2, 2>(part, Part::kPositionB) = sign * by_v;
      out.s_rate.block<2, 2>(part, Part::kPositionA) = -sign * by_v;
    }
  }

 private:
  Callback function_;
};

/// A row of the table of springs with its function.
struct PythonSpringRow : cases::SpringRow {
  Callback function;
};

void add_force_element(const std::string& name, const py::object& function,
                       const std::string& sentence) {
  static std::map<std::string, PythonSpringRow*>& all =
      kept(std::map<std::string, PythonSpringRow*>());
  if (const auto found = all.find(name); found != all.end()) {
    found->second->function = Callback(function);
    return;
  }
  auto& row = kept(PythonSpringRow{});
  row.name = kept(name).c_str();
  row.sentence = kept(sentence).c_str();
  row.points = true;
  row.axes = false;
  row.read = [](const io::Table&, cases::Spring&) {};
  row.make = [](const cases::Spring& spring, const fem::MarkerLocation& a,
                const fem::MarkerLocation& b, double) -> std::unique_ptr<fem::ForceElement> {
    return std::make_unique<PythonForce>(spring.name, a, b,
                                         static_cast<const PythonSpringRow*>(spring.row)->function);
  };
  row.function = Callback(function);
  cases::register_spring(row);
  all[name] = &row;
}

// --- optimizers

/// The search of an optimizer, as a function of Python sees it. It is valid during the call of the
/// function only.
class PythonSearch {
 public:
  PythonSearch(optim::Search& search, const optim::Settings& settings)
      : search_(&search), settings_(settings) {
    points_.push_front(search.start());
  }
  void end() { search_ = nullptr; }

  VectorXd start() const { return points_.back().x; }
  VectorXd lower() { return search().lower(); }
  VectorXd upper() { return search().upper(); }
  int n() { return search().n(); }
  int m() { return search().m(); }
  const optim::Settings& settings() const { return settings_; }

  /// Evaluates a design; None if it is refused.
  py::object evaluate(const VectorXd& x) {
    const optim::Point* known = find(x);
    if (known == nullptr) {
      optim::Point point{x, {}};
      optim::Trial trial{};
      {
        const py::gil_scoped_release release;
        trial = search().evaluate(point.x, point.response);
      }
      if (trial != optim::Trial::taken) return py::none();
      constexpr size_t kKept = 8;
      if (points_.size() == kKept) points_.erase(points_.end() - 2);  // the start stays
      known = &points_.emplace_front(std::move(point));
    }
    const optim::ProblemValues& r = known->response;
    return py::make_tuple(r.f, r.df, r.g, r.dg);
  }
  /// Records a design as a row of the history. @return false if the search has ended
  bool iterate(const VectorXd& x) {
    const optim::Point* known = find(x);
    if (known == nullptr) throw py::value_error("iterate(x): evaluate(x) comes first");
    if (known != &recorded_) recorded_ = *known;
    const py::gil_scoped_release release;
    return search().row(++rows_, recorded_);
  }

 private:
  optim::Search& search() {
    if (search_ == nullptr) throw std::runtime_error("the search has ended");
    return *search_;
  }
  /// Returns the design x if it is the last one of the history or one of the last evaluated ones.
  const optim::Point* find(const VectorXd& x) const {
    const auto is_x = [&x](const optim::Point& p) {
      return p.x.size() == x.size() &&
             std::memcmp(p.x.data(), x.data(), sizeof(double) * static_cast<size_t>(x.size())) == 0;
    };
    if (is_x(recorded_)) return &recorded_;
    const auto found = std::ranges::find_if(points_, is_x);
    return found == points_.end() ? nullptr : &*found;
  }

  optim::Search* search_;
  optim::Settings settings_;
  std::deque<optim::Point> points_;
  optim::Point recorded_;  // design of the last row of the history
  int rows_ = 0;
};

/// An optimizer that is a function of Python.
class PythonOptimizer final : public optim::Optimizer {
 public:
  PythonOptimizer(optim::Settings settings, Callback function)
      : settings_(std::move(settings)), function_(std::move(function)) {}
  optim::Result minimize(optim::Problem& problem, const optim::Observer& observe) override {
    optim::Search search(problem, settings_, observe);
    const auto seen = std::make_shared<PythonSearch>(search, settings_);
    try {
      const py::gil_scoped_acquire acquire;
      const py::object wrapped =
          py::module_::import("flexmorph._parts").attr("Search")(py::cast(seen));
      function_.get()(wrapped);
    } catch (...) {
      seen->end();
      throw;
    }
    seen->end();
    search.stop(optim::Stop::converged, "the function of the optimizer has returned");
    return search.result();
  }

 private:
  optim::Settings settings_;
  Callback function_;
};

void add_optimizer(const std::string& name, const py::object& function) {
  static Functions& all = kept(Functions());
  if (!all.put(name, function)) return;
  const std::string& own = kept(name);
  optim::register_optimizer(kept(optim::OptimizerRow{
      own.c_str(), [&own](const optim::Settings& settings) -> std::unique_ptr<optim::Optimizer> {
        return std::make_unique<PythonOptimizer>(settings, all.at(own));
      }}));
}

}  // namespace

void bind_parts(py::module_& m) {
  m.def("add_response", &add_response);
  m.def("add_drive", &add_drive);
  m.def("add_force_element", &add_force_element);
  m.def("add_optimizer", &add_optimizer);
  py::class_<PythonSearch, std::shared_ptr<PythonSearch>>(m, "Search")
      .def_property_readonly("x0", &PythonSearch::start)
      .def_property_readonly("lower", &PythonSearch::lower)
      .def_property_readonly("upper", &PythonSearch::upper)
      .def_property_readonly("n", &PythonSearch::n)
      .def_property_readonly("m", &PythonSearch::m)
      .def_property_readonly("options",
                             [](const PythonSearch& s) {
                               py::dict out = py::cast(s.settings().options);
                               out["max_iterations"] = s.settings().max_iterations;
                               out["move_limit"] = s.settings().move_limit;
                               out["kkt_tolerance"] = s.settings().kkt_tolerance;
                               out["feasibility"] = s.settings().feasibility;
                               return out;
                             })
      .def("evaluate", &PythonSearch::evaluate)
      .def("iterate", &PythonSearch::iterate);
}

}  // namespace flexmorph::python
