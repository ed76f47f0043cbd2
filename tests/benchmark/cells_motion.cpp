// Prints results of motions on cells; started by hand:
//
//   cells_motion plate SPEED STEP WIDTH...
//       uniform rotating plate, WIDTH cells across, compared with h16 and a Reissner beam
//   cells_motion cut CASE COMPONENTS [SLOWER [WHERE]]
//       a chord of a design is cut over two cells at this fraction of the length, in a motion and
//       in its static problem; speeds are divided by SLOWER
//   cells_motion rank CASE COMPONENTS moved|shortened|slit [CHANGE...]
//       20 disturbed designs of one volume: rank correlation of their compliances and motions
//
// CASE has one designed plate in a hub; COMPONENTS is the components.csv of a run.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "cases/assembly/build.h"
#include "io/case_files/case_file.h"
#include "tests/benchmark/cpu.h"
#include "tests/support/reissner_beam.h"
#include "tests/support/tip_history.h"

namespace {

using namespace flexmorph;
using testing::RotatingPlate;
using testing::ShapeSet;

constexpr int kTimes = 100;

void show(const char* name, const testing::PlateHistory& found, const VectorXd& h16,
          const VectorXd& beam, double seconds) {
  std::printf("| %s | %.3f | %.3f | %d | %.0f |\n", name,
              100 * testing::rms_apart(found.deflection, h16),
              100 * testing::rms_apart(found.deflection, beam), found.counts.newton, seconds);
  std::fflush(stdout);
}

void plates(double speed, double step, const std::vector<int>& widths) {
  reference::ReissnerBeam b;
  b.speed = speed;
  const VectorXd beam =
      reference::simulate(b, VectorXd::LinSpaced(kTimes, 1.0 / kTimes, 1)).deflection;
  RotatingPlate p;
  p.speed = speed;
  VectorXd h16;
  std::printf("v %.1f, rms of the tip's deflection over 1 s in %% of its largest\n", speed);
  std::printf("| mesh at the end | from h16 40 x 8 | from the beam | Newton | CPU s |\n");
  for (const int ny : {8, 4, 2}) {
    p.nx = 5 * ny;
    p.ny = ny;
    const double start = cpu_seconds();
    const testing::PlateHistory found = testing::tip_history(p, 1, kTimes, step);
    if (h16.size() == 0) h16 = found.deflection;
    show(("h16 " + std::to_string(p.nx) + " x " + std::to_string(ny) + " at the start").c_str(),
         found, h16, beam, cpu_seconds() - start);
  }
  p.shapes = ShapeSet::q4;
  VectorXd before, older;
  for (const int ny : widths) {
    p.nx = 5 * ny;
    p.ny = ny;
    const double start = cpu_seconds();
    const testing::PlateHistory found = testing::tip_history(p, 1, kTimes, step);
    const auto length = static_cast<int>(std::lround(p.whole() / p.width() * ny));
    show((std::to_string(length) + " x " + std::to_string(ny) + " cells").c_str(), found, h16, beam,
         cpu_seconds() - start);
    if (older.size() > 0)
      std::printf("order by three meshes %.2f\n",
                  std::log2((before - older).norm() / (found.deflection - before).norm()));
    older = before;
    before = found.deflection;
  }
}

/// The plate of a case with the components of a run.
struct Designed {
  cases::Scene scene;
  mmc::BodyProblem problem;

  static Designed of(const std::string& path, const std::string& components,
                     std::vector<std::string> changes) {
    changes.push_back("design.start=\"" + components + "\"");
    changes.emplace_back("verify=");
    cases::Scene scene = cases::read_scene(io::CaseFile(path, changes));
    std::vector<mmc::BodyProblem> problems = cases::build_problems(scene);
    return {std::move(scene), std::move(problems.front())};
  }
};

struct Moved {
  double integral = 0, amplitude = 0, seconds = 0;
  std::string failure;
  fem::EslSets loads;
};

/// Computes the motion with scale factors, on the elements of the case or on cells, and its
/// equivalent static loads.
Moved move(const cases::Scene& scene, const fem::ScaleFactors& factors,
           const cases::MeshChoice& mesh) {
  cases::Mechanism m = cases::build_mechanism(scene, mesh);
  m.model.set_factors(m.model.bodies()[0], factors);
  m.motion.balance = false;
  for (const double t : cases::load_times(scene)) m.motion.stops.push_back(t);
  const std::string body = scene.designs[0].body;
  const std::vector<fem::AttachedMass> masses = cases::attached_masses(scene, body);
  const Vec2 tip(scene.body(body).longest(scene.time.end), 0);
  Moved out;
  out.loads.grid = scene.designs[0].grid;
  double last_t = 0, last_u = 0;
  const double start = cpu_seconds();
  const auto observe = [&](const fem::MotionStep& s) {
    out.integral += 0.5 * (s.x.t - last_t) * (last_u + s.energies.strain);
    last_t = s.x.t;
    last_u = s.energies.strain;
    const fem::FrameMotion hub = m.moving_roots[0].hub.drive()(s.x.t);
    const Vec2 r = fem::point_motion(s.model.body(body), s.x, tip).position - hub.origin;
    out.amplitude = std::max(out.amplitude,
                             std::abs(-std::sin(hub.angle) * r.x() + std::cos(hub.angle) * r.y()));
    if (!s.stop || s.x.t == 0) return;
    out.loads.sets.push_back(fem::equivalent_static_load(
        s.model, s.x, m.moving_roots[0], out.loads.grid, masses, {}, m.motion.gravity));
    out.loads.sets.back().weight = 1.0 / scene.esl->count(scene.time.end);
  };
  try {
    fem::integrate(m.model, m.moving_roots, m.motion, observe);
  } catch (const Error& error) {
    out.failure = error.what();
  }
  out.seconds = cpu_seconds() - start;
  return out;
}

/// Returns Σ w F · u with the scale factors of the motion.
double compliance(const mmc::BodyProblem& problem, const fem::EslSets& loads,
                  const VectorXd& stiffness, const VectorXd& mass) {
  mmc::ComplianceEvaluator all(loads, problem.section, problem.compliance, stiffness, mass);
  return all.sum(stiffness, mass);
}

/// Removes the material of two columns from the upper edge down to the first void at the fraction
/// `at` of the length: this cuts a chord of a truss.
fem::ScaleFactors cut_chord(fem::ScaleFactors f, double at, double empty, double empty_mass) {
  const Grid& g = f.grid;
  const int i = static_cast<int>(at * g.nx);
  int j = g.ny - 1;
  while (j >= 0 && f.mass[g.cell(i, j)] < 0.5) --j;
  int n = 0;
  for (; j >= 0 && (f.mass[g.cell(i, j)] >= 0.05 || f.mass[g.cell(i + 1, j)] >= 0.05); --j, ++n)
    for (const int k : {i, i + 1}) {
      f.stiffness[g.cell(k, j)] = empty;
      f.mass[g.cell(k, j)] = empty_mass;
    }
  std::printf("cut at X = %.4f m: two cells along, %d across, down to Y = %.4f m\n", i * g.dx(), n,
              g.y0 + (j + 1) * g.dy());
  return f;
}

void cut(const std::string& path, const std::string& components, double slower, double at) {
  std::vector<std::string> changes;
  const cases::Scene shipped = Designed::of(path, components, {}).scene;
  const auto change = [&](const std::string& key, double value) {
    char text[100];
    std::snprintf(text, sizeof text, "%s=%.17g", key.c_str(), value);
    changes.emplace_back(text);
  };
  change("time.end", shipped.time.end * slower);
  change("time.step", shipped.time.step * slower);
  change("esl.every", shipped.esl->every * slower);
  change("hub.angular_velocity", shipped.hubs[0].angular_velocity / slower);
  change("body.flow.speed", shipped.bodies[0].flow->speed / slower);
  const Designed d = Designed::of(path, components, changes);
  const fem::ScaleFactors whole = mmc::dynamic_factors(d.problem, d.problem.design.components());
  const fem::ScaleFactors severed =
      cut_chord(whole, at, d.problem.stiffness_void, d.problem.mass_void);
  std::printf("speeds / %g\n| | tip mm | int U dt, J s | after / before - 1 | CPU s |\n", slower);
  const auto row = [](const char* name, const Moved& m, double before) {
    std::printf("| %s | %.5g | %.5g | %.1f %% | %.0f | %s\n", name, 1e3 * m.amplitude, m.integral,
                100 * (m.integral / before - 1), m.seconds, m.failure.c_str());
    std::fflush(stdout);
  };
  const Moved h16 = move(d.scene, whole, {});
  row("h16, whole", h16, h16.integral);
  row("h16, cut", move(d.scene, severed, {}), h16.integral);
  cases::MeshChoice cells;
  cells.cells = 1;
  const Moved on_cells = move(d.scene, whole, cells);
  const double before = compliance(d.problem, on_cells.loads, whole.stiffness, whole.mass);
  const double after = compliance(d.problem, on_cells.loads, severed.stiffness, severed.mass);
  std::printf("| compliance | | %.5g, cut %.5g | %.1f %% | |\n", before, after,
              100 * (after / before - 1));
  row("cells, whole", on_cells, on_cells.integral);
  const Moved apart = move(d.scene, severed, cells);
  row("cells, cut", apart, on_cells.integral);
  if (!apart.failure.empty()) return;
  std::printf("increase in the motion / increase of the compliance: %.3f\n",
              (apart.integral / on_cells.integral - 1) / (after / before - 1));
}

/// Returns the ranks of values, from 0; no two values are equal.
VectorXd ranks(const std::vector<double>& values) {
  std::vector<size_t> order(values.size());
  std::iota(order.begin(), order.end(), size_t(0));
  std::sort(order.begin(), order.end(), [&](size_t a, size_t b) { return values[a] < values[b]; });
  VectorXd out(static_cast<Eigen::Index>(values.size()));
  for (size_t k = 0; k < order.size(); ++k)
    out[static_cast<Eigen::Index>(order[k])] = static_cast<double>(k);
  return out;
}
double spearman(const std::vector<double>& a, const std::vector<double>& b) {
  const VectorXd x = ranks(a).array() - ranks(a).mean(), y = ranks(b).array() - ranks(b).mean();
  return x.dot(y) / x.norm() / y.norm();
}

/// Kinds of differences between a design and the first one: all components moved and rotated by up
/// to a length; or all components shortened by up to a fraction of their length, which disconnects
/// some; or (`slit`) components moved by half of that length and a slit in a flange.
enum class Family { moved, shortened, slit };

/// Returns components that are disturbed at random and then thickened or thinned until the volume
/// is as before.
/// @param size  1 means 6 mm of displacement, or 20 % of a length
std::vector<Component> disturbed(const mmc::BodyProblem& problem, Family family, double size,
                                 unsigned seed) {
  std::mt19937 engine(seed);
  const auto draw = [&] { return size * (2 * (static_cast<double>(engine()) / 4294967295.0) - 1); };
  const double kMove = family == Family::slit ? 0.003 : 0.006, kShorten = 0.2;
  std::vector<Component> moved = problem.design.components();
  const double wanted = mmc::fractions_of(problem, moved).mean();
  for (Component& c : moved) {
    if (family == Family::shortened) {
      c.half_length *= 1 - kShorten * std::abs(draw());
      continue;
    }
    c.center += kMove * Vec2(draw(), draw());
    c.angle += kMove * draw() / c.half_length;
    c.half_length += kMove * draw();
  }
  const auto scaled = [&](double by) {
    std::vector<Component> out = moved;
    for (Component& c : out)
      for (double* thickness : {&c.c1, &c.c2, &c.c3}) *thickness *= by;
    return out;
  };
  double low = 0.3, high = 3;
  for (int k = 0; k < 40; ++k) {
    const double middle = 0.5 * (low + high);
    (mmc::fractions_of(problem, scaled(middle)).mean() < wanted ? low : high) = middle;
  }
  return scaled(low);
}

/// Cuts a slit from the outside of a flange at random: two cells wide and zero to four cells deep.
void cut_slit(const Grid& g, unsigned seed, VectorXd& fractions) {
  std::mt19937 engine(1000 + seed);
  const auto below = [&](unsigned long n) { return static_cast<int>(engine() % n); };
  const int i = g.nx * 35 / 100 + below(static_cast<unsigned long>(g.nx * 6 / 10));
  const bool upper = below(2) == 1;
  const int depth = below(5);
  const auto row = [&](int k) { return upper ? g.ny - 1 - k : k; };
  int first = 0;
  while (first < g.ny - 1 && fractions[g.cell(i, row(first))] < 0.5) ++first;
  for (int k = first; k < std::min(g.ny, first + depth); ++k)
    for (const int column : {i, i + 1}) fractions[g.cell(column, row(k))] = 0;
}

void rank(const std::string& path, const std::string& components, Family family,
          const std::vector<std::string>& changes) {
  const Designed d = Designed::of(path, components, changes);
  cases::MeshChoice cells;
  cells.cells = 1;
  std::vector<double> statics, coarse, fine;
  std::printf(
      "| disturbed by | volume | crisp compliance J | h16 int U dt J s | cells J s | CPU s |\n");
  constexpr int kDesigns = 20;
  for (int k = 0; k < kDesigns; ++k) {
    const double size = k / (kDesigns - 1.0);
    const std::vector<Component> moved =
        disturbed(d.problem, family, size, static_cast<unsigned>(k + 1));
    VectorXd fractions = mmc::fractions_of(d.problem, moved);
    if (family == Family::slit) cut_slit(d.problem.grid, static_cast<unsigned>(k + 1), fractions);
    const mmc::CellScaleFactors dynamic =
        mmc::Ersatz::dynamic(fractions, d.problem.stiffness_void, d.problem.mass_void);
    const fem::ScaleFactors factors{d.problem.grid, dynamic.stiffness, dynamic.mass};
    const mmc::CellScaleFactors crisp = mmc::ersatz_of(d.problem).crisp(fractions);
    const Moved on_h16 = move(d.scene, factors, {});
    const Moved on_cells = move(d.scene, factors, cells);
    const double c = compliance(d.problem, on_h16.loads, crisp.stiffness, crisp.mass);
    std::printf("| %.2f | %.4f | %.5g | %.5g | %.5g | %.0f | %s\n", size, fractions.mean(), c,
                on_h16.integral, on_cells.integral, on_cells.seconds, on_cells.failure.c_str());
    std::fflush(stdout);
    if (!on_cells.failure.empty() || !on_h16.failure.empty()) continue;
    statics.push_back(c);
    coarse.push_back(on_h16.integral);
    fine.push_back(on_cells.integral);
  }
  std::printf(
      "Spearman of %zu: compliance and cells %.3f, compliance and h16 %.3f, cells and h16 %.3f\n",
      statics.size(), spearman(statics, fine), spearman(statics, coarse), spearman(fine, coarse));
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::begin(argv);
  const std::vector<std::string> words(argv + 1, argv + argc);
  const auto number = [&](size_t k, double otherwise) {
    return k < words.size() ? std::stod(words[k]) : otherwise;
  };
  if (words.size() >= 4 && words[0] == "plate") {
    std::vector<int> widths;
    for (size_t k = 3; k < words.size(); ++k) widths.push_back(std::stoi(words[k]));
    plates(number(1, 0.5), number(2, 1e-3), widths);
  } else if (words.size() >= 3 && words[0] == "cut") {
    cut(words[1], words[2], number(3, 1), number(4, 0.55));
  } else if (words.size() >= 4 && words[0] == "rank") {
    rank(words[1], words[2],
         words[3] == "moved"       ? Family::moved
         : words[3] == "shortened" ? Family::shortened
                                   : Family::slit,
         {words.begin() + 4, words.end()});
  } else {
    std::printf(
        "plate SPEED STEP WIDTH... | cut CASE COMPONENTS [SLOWER [WHERE]] | rank CASE COMPONENTS "
        "[CHANGE...]\n");
    return 2;
  }
}
