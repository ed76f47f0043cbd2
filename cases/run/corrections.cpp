#include "cases/run/corrections.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "cases/assembly/scene_motion.h"
#include "cases/results/correction_messages.h"
#include "cases/run/motion_run.h"
#include "io/files.h"
#include "io/plots.h"
#include "io/tables.h"
#include "optim/mmc/loads/compliance_evaluator.h"
#include "optim/mmc/problem/finished_part.h"

namespace flexmorph::cases {
namespace {

/// The static problems of all designs under constant loads.
class LoadsOfDesigns {
 public:
  explicit LoadsOfDesigns(std::vector<fem::EslSets> loads) : loads_(std::move(loads)) {}
  std::vector<std::unique_ptr<mmc::ComplianceEvaluator>> of(
      const std::vector<mmc::BodyProblem>& problems) const {
    std::vector<std::unique_ptr<mmc::ComplianceEvaluator>> out;
    for (size_t k = 0; k < problems.size(); ++k) {
      const mmc::BodyProblem& p = problems[k];
      const mmc::CellScaleFactors factors =
          mmc::ersatz_of(p).crisp(mmc::part_fractions(p, p.design.components()));
      out.push_back(std::make_unique<mmc::ComplianceEvaluator>(loads_[k], p.section, p.compliance,
                                                               factors.stiffness, factors.mass));
    }
    return out;
  }
  std::vector<fem::EslSets>& sets() { return loads_; }

 private:
  std::vector<fem::EslSets> loads_;
};

/// Returns a picture with arrows that show in which direction a component has to move so that the
/// objective of the motion decreases. The arrows begin at the centres of the components, and the
/// longest arrow has a twentieth of the size of the picture.
std::string picture_of(const mmc::BodyProblem& problem,
                       const mmc::OptimalityCertificate::Body& certified) {
  const Grid& g = problem.grid;
  constexpr double kArrow = 0.05;  // length of the longest arrow and of the margin / picture size
  const Vec2 corner(g.x0, g.y0), room = Vec2::Constant(kArrow * std::max(g.width, g.height));
  const Box frame{corner - room, corner + Vec2(g.width, g.height) + room};
  std::string svg =
      io::outline_svg(mmc::part_of(problem, problem.design.components(), 0.05 * g.dx()), frame, 5);
  double longest = 0;
  const auto pull = [&](size_t c) {
    return Vec2(-certified.slopes.segment<2>(static_cast<Eigen::Index>(7 * c)));
  };
  for (size_t c = 0; c < certified.components.size(); ++c)
    longest = std::max(longest, pull(c).norm());
  if (longest == 0) return svg;
  const double size = std::max(g.width, g.height), scale = kArrow * size / longest,
               line = 0.0025 * size;
  std::string arrows;
  for (size_t c = 0; c < certified.components.size(); ++c) {
    const Vec2 from = certified.components[c].center, along = scale * pull(c), to = from + along;
    if (along.norm() < 2 * line) continue;
    const Vec2 back = 0.3 * along, side = 0.12 * Vec2(-along.y(), along.x());
    const auto at = [](const Vec2& p) {
      return io::to_text(p.x(), 6) + " " + io::to_text(p.y(), 6);
    };
    arrows += "M" + at(from) + "L" + at(to) + "M" + at(to - back + side) + "L" + at(to) + "L" +
              at(to - back - side);
  }
  const std::string path = "<path fill=\"none\" stroke=\"#f08020\" stroke-width=\"" +
                           io::to_text(line, 3) + "\" d=\"" + arrows + "\"/>\n";
  return svg.insert(svg.rfind("</g>"), path);
}

void write_certificate(const Scene& scene, const mmc::OptimalityCertificate& certificate,
                       const std::vector<mmc::BodyProblem>& problems, RunFolder& folder) {
  static const std::vector<std::string> kColumns = {
      "component", "x", "y", "by_x", "by_y", "by_length", "by_angle", "by_c1", "by_c2", "by_c3"};
  for (size_t b = 0; b < certificate.bodies.size(); ++b) {
    const mmc::OptimalityCertificate::Body& body = certificate.bodies[b];
    const std::string stem = "certificate" + (scene.designs.size() > 1 ? "_" + body.body : "");
    io::CsvWriter csv(folder.file(stem + ".csv"), kColumns);
    for (size_t c = 0; c < body.components.size(); ++c) {
      std::vector<io::Cell> row = {static_cast<int>(c + 1), body.components[c].center.x(),
                                   body.components[c].center.y()};
      for (Eigen::Index k = 0; k < Component::kParameters; ++k)
        row.emplace_back(body.slopes[Component::kParameters * static_cast<Eigen::Index>(c) + k]);
      csv.row(row);
    }
    folder.write_text(stem + ".svg", picture_of(problems[b], body));
  }
}

}  // namespace

namespace {

/// Computes the equivalent static loads of the motion with the given designs, on their grids.
LoadsOfDesigns loads_of(const RunContext& run, const PreparedCase& prepared,
                        const std::vector<mmc::BodyProblem>& problems) {
  MotionRequest request;
  for (const mmc::BodyProblem& p : problems)
    request.factors.push_back(mmc::dynamic_factors(p, p.design.components()));
  request.loads = true;
  request.balance = false;
  request.keep_running = run.keep_running;
  request.table = "motion_corrected.csv";
  return LoadsOfDesigns(run_motion(prepared, request, run.folder).loads);
}

/// Returns the scene with designs on cells of another size [m]. The widths of the bands, measured
/// in cells, do not change.
Scene with_cells(Scene scene, double cell) {
  for (BodyDesign& d : scene.designs) {
    const auto n = static_cast<int>(std::lround(cell / d.grid.dx()));
    if (cell <= 0 || n == 1) continue;
    d.grid.nx /= n;
    d.grid.ny /= n;
    d.tdf.sharpness /= n;
    d.tdf = d.at_band(d.band.size() - 1);
  }
  return scene;
}

/// Copies designs to problems with the same bodies, whose grids may differ.
void take_designs(const std::vector<mmc::BodyProblem>& from, std::vector<mmc::BodyProblem>& to) {
  for (size_t k = 0; k < to.size(); ++k)
    to[k].design = to[k].design.with(from[k].design.components());
}

/// Returns the objective J of the crisp outlines of the designs, on the cells of the case.
double crisp_value(const RunContext& run, const std::vector<mmc::BodyProblem>& problems) {
  SceneMotion motion(run.prepared, {0, run.scene().time.step, 0}, run.keep_running);
  return mmc::crisp_objective(problems, motion);
}

/// The corrected cycles of a run.
class Correcting {
 public:
  Correcting(const RunContext& run, DesignResult& design) : run_(run), design_(design) {}

  void go(std::vector<fem::EslSets>& loads) {
    const std::vector<mmc::BodyProblem> plain = design_.problems;
    if (run_.folder)
      for (const mmc::BodyProblem& problem : plain)
        run_.folder->keep_outline(problem, "design_esl");
    correct();
    if (design_.corrections.size() < 2) {  // nothing was corrected
      design_.problems = plain;
      return;
    }
    LoadsOfDesigns last = loads_of(run_, run_.prepared, design_.problems);
    std::vector<mmc::BodyOutcome> found = outcomes(last);
    design_.corrected = {.before = crisp_value(run_, plain),
                         .after = crisp_value(run_, design_.problems)};
    run_.progress.say(corrected_text(*design_.corrected));
    if (!design_.corrected->improves()) {
      design_.problems = plain;
      return;
    }
    loads = std::move(last.sets());
    for (size_t k = 0; k < found.size(); ++k) take(std::move(found[k]), loads[k], k);
  }

 private:
  /// Runs the cycles and stores the corrected designs in the result.
  void correct() {
    const Scene& scene = run_.scene();
    const PreparedCase coarse(with_cells(scene, scene.cycle.cell));
    SceneMotion motion(coarse, {0, scene.cycle.step, scene.cycle.checkpoints}, run_.keep_running);
    std::vector<mmc::BodyProblem> problems = coarse.design_problems();
    take_designs(design_.problems, problems);
    std::optional<LoadsOfDesigns> current;
    const mmc::LoadsAt loads_at = [&] {
      current.emplace(loads_of(run_, coarse, problems));
      return current->of(problems);
    };
    const mmc::SeeCycle see = [&](const mmc::CorrectedCycle& cycle) {
      design_.corrections.push_back(cycle);
      if (run_.folder) run_.folder->write_cycles(design_.verdicts, design_.corrections);
      run_.progress.say(corrected_text(cycle));
      const int most = scene.cycle.correction.max_cycles;
      run_.progress.way("corrected cycles", (cycle.cycle + 1.0) / (most + 1.0),
                        "cycle " + std::to_string(cycle.cycle) + " of at most " +
                            std::to_string(most));
      return run_.keep_running();
    };
    mmc::correct_designs(problems, loads_at, motion, scene.cycle.correction, see);
    if (!run_.keep_running()) throw Interrupted();
    take_designs(problems, design_.problems);
  }

  std::vector<mmc::BodyOutcome> outcomes(const LoadsOfDesigns& loads) {
    const std::vector<std::unique_ptr<mmc::ComplianceEvaluator>> responses =
        loads.of(design_.problems);
    std::vector<mmc::LoadedBody> bodies;
    for (size_t k = 0; k < responses.size(); ++k)
      bodies.push_back({design_.problems[k], *responses[k]});
    std::vector<mmc::BodyOutcome> out = mmc::outcomes_of_corrected(bodies);
    if (!run_.keep_running()) throw Interrupted();
    return out;
  }

  /// Replaces the outcome of a body, keeps the numbers of its optimization, and writes the files.
  void take(mmc::BodyOutcome found, const fem::EslSets& loads, size_t body) {
    mmc::BodyOutcome& before = design_.outcomes[body];
    found.iterations = before.iterations;
    found.evaluations = before.evaluations;
    found.kkt = before.kkt;
    found.verdict = before.verdict;
    found.stop = before.stop + "; corrected cycles with " +
                 std::to_string(design_.corrections.back().motions) +
                 " motions then changed the design";
    if (found.length_scale) found.length_scale = before.length_scale;
    for (size_t l = 0; l < loads.sets.size(); ++l)
      found.energy_ratios.push_back(0.5 * found.load_compliances[l] / loads.sets[l].strain_energy);
    before = std::move(found);
    if (run_.folder == nullptr) return;
    run_.folder->write_loads(before.body, loads, &before);
    run_.folder->write_design(design_.problems[body], before);
  }

  const RunContext& run_;
  DesignResult& design_;
};

}  // namespace

void correct_by_motion(const RunContext& run, std::vector<fem::EslSets>& loads,
                       DesignResult& design) {
  run.progress.begin("corrected cycles");
  try {
    Correcting(run, design).go(loads);
  } catch (const StoppedMotion&) {
    throw Interrupted();
  }
}

mmc::OptimalityCertificate certify_by_motion(const RunContext& run, const Certify& settings,
                                             std::span<const fem::EslSets> loads,
                                             std::span<const mmc::BodyProblem> designs) {
  run.progress.begin("certificate");
  SceneMotion motion(run.prepared, {settings.cell, settings.step, settings.checkpoints},
                     run.keep_running);
  const LoadsOfDesigns kept({loads.begin(), loads.end()});
  // The problems are copied, because a certificate must not change the designs.
  std::vector<mmc::BodyProblem> problems(designs.begin(), designs.end());
  std::vector<std::unique_ptr<mmc::ComplianceEvaluator>> responses = kept.of(problems);
  std::vector<mmc::LoadedBody> bodies;
  for (size_t k = 0; k < problems.size(); ++k) bodies.push_back({problems[k], *responses[k]});
  mmc::OptimalityCertificate out;
  try {
    out = mmc::certify(bodies, motion, run.scene().optimizer.move_limit);
  } catch (const StoppedMotion&) {
    throw Interrupted();
  }
  if (run.folder) write_certificate(run.scene(), out, problems, *run.folder);
  run.progress.say("optimality certificate: " + certificate_text(out));
  return out;
}

}  // namespace flexmorph::cases
