#include "cases/run/path_run.h"

#include "cases/assembly/static_path.h"
#include "cases/output/animation_writer.h"
#include "cases/results/failure.h"
#include "cases/results/motion_columns.h"
#include "cases/scene/elements/row.h"
#include "fem/solve/redundancy.h"
#include "io/files.h"

namespace flexmorph::cases {
namespace {

/// Computes the rows of a path and passes its equilibria to the writers.
class PathSteps {
 public:
  PathSteps(const Scene& scene, Mechanism& mechanism, const fem::State& start, RunFolder* folder,
            PathRecord& out)
      : scene_(scene),
        model_(mechanism.model),
        measures_(scene, mechanism.model, start),
        mechanism_(scene),
        scales_(mechanism.model.scales()),
        before_(start.q),
        shapes_(scene, {}),
        out_(out) {
    for (const Observe& o : scene.observed) {
      const Body& body = scene.body(o.body);
      // The pose gives the positions of a body with material lines, whose points may still be
      // inside the hub. A body without material lines may be an arc, so its elements give the
      // positions.
      starts_.push_back(body.row->lines ? start_pose(scene, body).location(o.point)
                                        : fem::point_position(model_.body(o.body), start, o.point));
    }
    out.table = Series(path_columns(scene));
    writers_.push_back(std::make_unique<SeriesWriter>(out.table));
    if (scene.output.plots)
      writers_.push_back(std::make_unique<AnimationWriter>(shapes_, 2, out.animation));
    if (folder == nullptr) return;
    writers_.push_back(std::make_unique<TableWriter>(folder->file("path.csv"), out.table));
    if (scene.output.vtk) writers_.push_back(std::make_unique<FrameWriter>(shapes_, 1, *folder));
  }

  void add(const fem::StaticStep& step) {
    if (const fem::LeftOutMiss miss = fem::left_out_miss(model_, step.x.q, step.x.t); miss.is_large)
      throw Error::numerical("redundant joints do not agree with the others: the error of joint '" +
                             miss.joint + "' is " + io::to_text(miss.miss, 3) + " m");
    const double way = (step.x.q - before_).cwiseProduct(scales_).norm();
    out_.arc.push_back(out_.arc.empty() ? 0 : out_.arc.back() + way);
    before_ = step.x.q;
    const double heating = scene_.statics->temperatures_grow ? step.factor : 1;
    const auto number = static_cast<double>(out_.table.n_rows());
    row_ = {number, step.factor};
    for (size_t i = 0; i < starts_.size(); ++i) {
      const Observe& o = scene_.observed[i];
      const Vec3 u = fem::point_position(model_.body(o.body), step.x, o.point) - starts_[i];
      for (int c = 0; c < scene_.body(o.body).dim(); ++c) row_.push_back(u[c]);
    }
    const double strain = model_.energies(step.x).strain;
    measures_.append(model_, step.x, heating, row_);
    fem::State shown = step.x;
    shown.lambda = fem::least_multipliers(model_, step.x);
    mechanism_.append(model_, shown, row_);
    row_.insert(row_.end(), {strain, static_cast<double>(step.iterations)});
    const StepRecord record{model_, step.x, row_, static_cast<double>(step.number), heating};
    for (const auto& writer : writers_) writer->add(record);
  }

 private:
  const Scene& scene_;
  fem::Workspace& model_;
  BodyMeasures measures_;
  MechanismColumns mechanism_;
  VectorXd scales_, before_;
  BodyShapes shapes_;
  PathRecord& out_;
  std::vector<Vec3> starts_;  // positions of the observed points before the first step
  std::vector<double> row_;
  std::vector<std::unique_ptr<StepWriter>> writers_;
};

}  // namespace

PathRecord run_path(const PreparedCase& prepared, const PathRequest& request, RunFolder* folder) {
  const Scene& scene = prepared.scene();
  Mechanism mechanism = prepared.mechanism();
  fem::Workspace& model = mechanism.model;
  fem::State x = fem::start_state(model, mechanism.moving_roots, 0, fem::Start::rigid,
                                  mechanism.motion.body_poses);
  fem::leave_out_redundant(model, x);
  PathRecord out;
  out.redundant_joints = fem::redundant_joints(model);
  PathSteps steps(scene, mechanism, x, folder, out);
  const auto observe = [&](const fem::StaticStep& step) {
    steps.add(step);
    if (request.reached) request.reached(step.factor);
    if (request.keep_running && !request.keep_running()) throw Interrupted();
    return true;
  };
  try {
    begin_static_path(scene, model, x);
    fem::StaticSettings settings = static_settings(*scene.statics);
    settings.condition = request.condition;
    out.result = fem::solve_static(model, x, settings, observe);
  } catch (const Error& error) {
    Failure where;
    where.phase = "statics";
    const auto n = static_cast<int>(out.table.n_rows());
    where.load_factor = n == 0 ? 0 : out.table.at(kFactorColumn).back();
    where.step = std::max(0, n - 1);  // the first row is the start
    if (request.unfinished) *request.unfinished = std::move(out);
    throw FailedRun(error, where);
  } catch (...) {
    if (request.unfinished) *request.unfinished = std::move(out);
    throw;
  }
  return out;
}

}  // namespace flexmorph::cases
