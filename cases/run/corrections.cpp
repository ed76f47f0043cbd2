#include "cases/run/corrections.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "cases/assembly/scene_motion.h"
#include "io/files.h"
#include "io/plots.h"
#include "io/tables.h"
#include "optim/mmc/compliance_evaluator.h"

namespace flexmorph::cases {
namespace {

double degrees(double angle) { return angle * 180 / std::numbers::pi; }

/// Static problems of all designs under loads that they keep.
class LoadsOfDesigns {
 public:
  explicit LoadsOfDesigns(std::vector<fem::EslSets> loads) : loads_(std::move(loads)) {}
  std::vector<std::unique_ptr<mmc::ComplianceEvaluator>> of(
      const std::vector<mmc::BodyProblem>& problems) const {
    std::vector<std::unique_ptr<mmc::ComplianceEvaluator>> out;
    for (size_t k = 0; k < problems.size(); ++k) {
      const mmc::BodyProblem& p = problems[k];
      const mmc::CellFactors factors =
          mmc::ersatz_of(p).sharp(mmc::fractions_of(p, p.design.components()));
      out.push_back(std::make_unique<mmc::ComplianceEvaluator>(loads_[k], p.section, p.compliance,
                                                               factors.stiffness, factors.mass));
    }
    return out;
  }
  std::vector<fem::EslSets>& sets() { return loads_; }

 private:
  std::vector<fem::EslSets> loads_;
};

/// Where the motion would move material: an arrow from the centre of every component, the longest
/// of them a twentieth of the picture.
std::string picture_of(const mmc::BodyProblem& problem,
                       const mmc::MotionCertificate::Body& certified) {
  const Grid& g = problem.grid;
  constexpr double kArrow = 0.05;  // of the picture: as much room is around it
  const Vec2 corner(g.x0, g.y0), room = Vec2::Constant(kArrow * std::max(g.width, g.height));
  const Box frame{corner - room, corner + Vec2(g.width, g.height) + room};
  std::string svg = io::outline_svg(
      mmc::regions_of(problem, problem.design.components(), 0.05 * g.dx()), frame, 5);
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

void write_certificate(const Scene& scene, const mmc::MotionCertificate& certificate,
                       const std::vector<mmc::BodyProblem>& problems, RunFolder& folder) {
  static const std::vector<std::string> kColumns = {
      "component", "x", "y", "by_x", "by_y", "by_length", "by_angle", "by_c1", "by_c2", "by_c3"};
  for (size_t b = 0; b < certificate.bodies.size(); ++b) {
    const mmc::MotionCertificate::Body& body = certificate.bodies[b];
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

std::string certificate_words(const mmc::MotionCertificate& c) {
  return c.objective + " " + io::to_text(c.value, 5) + " (sharp " + io::to_text(c.sharp_value, 5) +
         "), KKT residual " + io::to_text(c.kkt, 3) + ", gradients of motion and loads " +
         io::to_text(degrees(c.angle), 3) + " degrees apart, at most " +
         io::to_text(100 * c.left, 3) + " % left within a move of " + io::to_text(c.move_limit, 3);
}

std::string corrected_words(const mmc::CorrectedCycle& c) {
  std::string out = "cycle " + std::to_string(c.cycle) + " of the motion: J " +
                    io::to_text(c.value, 6) + ", KKT residual " + io::to_text(c.kkt, 3);
  if (c.cycle == 0)
    return out + ", gradients of motion and loads " + io::to_text(degrees(c.angle), 3) +
           " degrees apart";
  if (c.predicted != 0)
    out += ", within " + io::to_text(c.radius, 3) + " predicted " +
           io::to_text(100 * c.predicted, 3) + " % less, found " + io::to_text(100 * c.actual, 3) +
           " %";
  return out + (c.accepted ? "" : ", not taken");
}

namespace {

/// The loads of the motion with the designs of these problems, on their grids.
LoadsOfDesigns loads_of(const Scene& scene, const std::vector<mmc::BodyProblem>& problems,
                        const std::function<bool()>& go_on, RunFolder& folder) {
  MotionWishes wishes;
  for (const mmc::BodyProblem& p : problems)
    wishes.factors.push_back(mmc::dynamic_factors(p, p.design.components()));
  wishes.loads = true;
  wishes.balance = false;
  wishes.go_on = go_on;
  wishes.table = "motion_corrected.csv";
  return LoadsOfDesigns(run_motion(scene, wishes, folder).loads);
}

/// The scene with designs on cells of another size; their bands are as many of them.
Scene with_cells(Scene scene, double cell) {
  for (BodyDesign& d : scene.designs) {
    const auto n = static_cast<int>(std::lround(cell / d.grid.dx()));
    if (cell <= 0 || n == 1) continue;
    d.grid.nx /= n;
    d.grid.ny /= n;
    d.tdf.sharpness /= n;
    d.tdf.erosion *= n;
    d.tdf = d.stage(d.band.size() - 1);
  }
  return scene;
}

/// Corrected designs of other problems, on their own grids.
void take_designs(const std::vector<mmc::BodyProblem>& from, std::vector<mmc::BodyProblem>& to) {
  for (size_t k = 0; k < to.size(); ++k)
    to[k].design = to[k].design.without_symmetry().with(from[k].design.components());
}

/// J of the designs as their outlines are, on the cells of the case.
double sharp_value(const Scene& scene, const std::vector<mmc::BodyProblem>& problems,
                   const std::function<bool()>& go_on) {
  SceneMotion motion(scene, {0, scene.time.step, 0}, go_on);
  return mmc::sharp_objective(problems, motion);
}

/// The cycles of one run that correct its designs, and whether they are kept.
class Correcting {
 public:
  Correcting(const Scene& scene, const std::function<bool()>& go_on, RunFolder& folder,
             Progress& progress, RunReport& report)
      : scene_(scene), go_on_(go_on), folder_(folder), progress_(progress), report_(report) {}

  void go(std::vector<fem::EslSets>& loads) {
    const std::vector<mmc::BodyProblem> plain = report_.problems;
    for (const mmc::BodyProblem& problem : plain) folder_.keep_outline(problem, "design_esl");
    correct();
    if (report_.corrections.size() < 2) {  // nothing was corrected
      report_.problems = plain;
      return;
    }
    LoadsOfDesigns last = loads_of(scene_, report_.problems, go_on_, folder_);
    std::vector<mmc::BodyOutcome> found = outcomes(last);
    report_.corrected = {.before = sharp_value(scene_, plain, go_on_),
                         .after = sharp_value(scene_, report_.problems, go_on_)};
    progress_.say(corrected_words(*report_.corrected));
    if (!report_.corrected->pays()) {
      report_.problems = plain;
      return;
    }
    loads = std::move(last.sets());
    for (size_t k = 0; k < found.size(); ++k) take(std::move(found[k]), loads[k], k);
  }

 private:
  /// The cycles; the designs of the report are then what they came to.
  void correct() {
    const Scene coarse = with_cells(scene_, scene_.cycle.cell);
    SceneMotion motion(coarse, {0, scene_.cycle.step, scene_.cycle.checkpoints}, go_on_);
    std::vector<mmc::BodyProblem> problems = build_problems(coarse);
    take_designs(report_.problems, problems);
    std::optional<LoadsOfDesigns> current;
    const mmc::LoadsAt loads_at = [&] {
      current.emplace(loads_of(coarse, problems, go_on_, folder_));
      return current->of(problems);
    };
    const mmc::SeeCycle see = [&](const mmc::CorrectedCycle& cycle) {
      report_.corrections.push_back(cycle);
      folder_.write_cycles(report_.verdicts, report_.corrections);
      progress_.say(corrected_words(cycle));
      return go_on_();
    };
    mmc::correct_designs(problems, loads_at, motion, scene_.cycle.correction, see);
    if (!go_on_()) throw Interrupted();
    take_designs(problems, report_.problems);
  }

  std::vector<mmc::BodyOutcome> outcomes(const LoadsOfDesigns& loads) {
    const std::vector<std::unique_ptr<mmc::ComplianceEvaluator>> responses =
        loads.of(report_.problems);
    std::vector<mmc::LoadedBody> bodies;
    for (size_t k = 0; k < responses.size(); ++k)
      bodies.push_back({report_.problems[k], *responses[k]});
    std::vector<mmc::BodyOutcome> out = mmc::outcomes_of_corrected(bodies, go_on_);
    if (!go_on_()) throw Interrupted();
    return out;
  }

  /// The outcome of a body in place of the one before.
  void take(mmc::BodyOutcome found, const fem::EslSets& loads, size_t body) {
    mmc::BodyOutcome& before = report_.outcomes[body];
    found.iterations = before.iterations;
    found.evaluations = before.evaluations;
    found.kkt = before.kkt;
    found.stop = before.stop + "; then corrected by " +
                 std::to_string(report_.corrections.back().motions) + " motions";
    if (!found.clean_up) found.clean_up = before.clean_up;
    for (size_t l = 0; l < loads.sets.size(); ++l)
      found.energy_ratios.push_back(0.5 * found.load_compliances[l] / loads.sets[l].strain_energy);
    before = std::move(found);
    folder_.write_loads(before.body, loads, &before);
    folder_.write_design(report_.problems[body], before);
  }

  const Scene& scene_;
  const std::function<bool()>& go_on_;
  RunFolder& folder_;
  Progress& progress_;
  RunReport& report_;
};

}  // namespace

std::string corrected_words(const CorrectedMotion& c) {
  return "corrected, J of the outlines on the cells of the case is " + io::to_text(c.after, 6) +
         " instead of " + io::to_text(c.before, 6) +
         (c.pays() ? "" : ": no less, the designs for loads are kept");
}

void correct_by_motion(const Scene& scene, const std::function<bool()>& go_on,
                       std::vector<fem::EslSets>& loads, RunFolder& folder, Progress& progress,
                       RunReport& report) {
  progress.begin("corrected cycles");
  try {
    Correcting(scene, go_on, folder, progress, report).go(loads);
  } catch (const StoppedMotion&) {
    throw Interrupted();
  }
}

void certify_by_motion(const Scene& scene, const Certify& wishes,
                       std::span<const fem::EslSets> loads, const std::function<bool()>& go_on,
                       RunFolder& folder, Progress& progress, RunReport& report) {
  progress.begin("certificate");
  SceneMotion motion(scene, {wishes.cell, wishes.step, wishes.checkpoints}, go_on);
  const LoadsOfDesigns kept({loads.begin(), loads.end()});
  std::vector<std::unique_ptr<mmc::ComplianceEvaluator>> responses = kept.of(report.problems);
  // With copies: certifying leaves the designs as they are.
  std::vector<mmc::BodyProblem> problems = report.problems;
  std::vector<mmc::LoadedBody> bodies;
  for (size_t k = 0; k < problems.size(); ++k) bodies.push_back({problems[k], *responses[k]});
  std::vector<mmc::Part> parts = mmc::parts_at_end(bodies);
  try {
    report.certificate = mmc::certify(parts, motion, scene.optimizer.move_limit);
  } catch (const StoppedMotion&) {
    throw Interrupted();
  }
  write_certificate(scene, *report.certificate, problems, folder);
  progress.say("certificate: " + certificate_words(*report.certificate));
}

}  // namespace flexmorph::cases
