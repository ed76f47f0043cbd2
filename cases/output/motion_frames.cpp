#include "cases/output/motion_frames.h"

#include <cmath>

#include "cases/scene/elements/row.h"
#include "io/files.h"

namespace flexmorph::cases {
namespace {

io::QuadMesh rectangle(std::span<const Vec2> corners) {
  io::QuadMesh mesh;
  for (const Vec2& corner : corners) mesh.points.insert(mesh.points.end(), {corner[0], corner[1]});
  mesh.quads.push_back({0, 1, 2, 3});
  return mesh;
}

/// Returns the von Mises stress of a plate at material points [Pa].
std::vector<double> stress_of(const Body& plate, const StepRecord& step,
                              std::span<const Vec2> materials) {
  const fem::Body& model = step.model.body(plate.name);
  return membrane_stress(model, step.x, materials, plate.youngs_modulus, plate.poisson_ratio,
                         thermal_stretch(model, step.x.t, step.heating));
}

}  // namespace

BodyShapes::BodyShapes(const Scene& scene, std::vector<VectorXd> densities)
    : scene_(scene), densities_(std::move(densities)) {
  for (const Body& body : scene.bodies) poses_.push_back(start_pose(scene, body));
}

size_t BodyShapes::design_of(size_t body) const {
  size_t d = 0;
  while (d < scene_.designs.size() && scene_.designs[d].body != scene_.bodies[body].name) ++d;
  return d;
}

DesignedSurface BodyShapes::designed(const StepRecord& step, size_t body) const {
  const size_t d = design_of(body);
  const Grid& grid = scene_.designs[d].grid;
  const VectorXd density = densities_.empty() ? VectorXd::Ones(grid.n_cells()) : densities_[d];
  const Body& drawn = scene_.bodies[body];
  const fem::Body& model = step.model.body(drawn.name);
  return designed_surface(model, step.x, poses_[body], grid, density);
}

Surface BodyShapes::deformed(const StepRecord& step, size_t body) const {
  const Body& drawn = scene_.bodies[body];
  const fem::Body& model = step.model.body(drawn.name);
  return deformed_surface(*drawn.row, model, step.x, poses_[body], step.heating);
}

void FrameWriter::add(const StepRecord& step) {
  const bool motion = !shapes_.scene().statics;
  const double at = step.abscissa / every_;
  if (motion && (!step.stop || std::abs(at - std::round(at)) >= 1e-6)) return;
  add_bodies(step);
  if (motion) add_rigid_parts(step);
}

void FrameWriter::add_bodies(const StepRecord& step) {
  const Scene& scene = shapes_.scene();
  for (size_t i = 0; i < scene.bodies.size(); ++i) {
    const Body& body = scene.bodies[i];
    const int part = static_cast<int>(i);
    if (shapes_.is_designed(i)) {
      DesignedSurface surface = shapes_.designed(step, i);
      surface.stress = stress_of(body, step, surface.middles);
      for (size_t k = 0; k < surface.stress.size(); ++k) surface.stress[k] *= surface.density[k];
      folder_.add_motion_frame(body.name, surface, step.abscissa, part);
    } else {
      Surface surface = shapes_.deformed(step, i);
      if (body.row->across) surface.stress = stress_of(body, step, surface.middles);
      folder_.add_surface_frame(body.name, surface, step.abscissa, part);
    }
  }
}

void FrameWriter::add_rigid_parts(const StepRecord& step) {
  const Scene& scene = shapes_.scene();
  const double t = step.abscissa;
  int part = static_cast<int>(scene.bodies.size());
  for (const RigidBody& body : scene.rigid_bodies) {
    const std::vector<Vec2> corners = drawn_corners(body, step.model, step.x);
    if (!corners.empty()) folder_.add_rigid_frame(body.name, rectangle(corners), t, part);
    ++part;
  }
  for (const Hub& hub : scene.hubs) {
    Joint held;  // stands for a joint that is welded to the hub
    held.to = hub.name;
    const fem::FrameMotion frame = hub_drive(scene, held)(t);
    if (const double radius = drawn_radius(scene, hub); radius > 0)
      folder_.add_rigid_frame(hub.name, disc_mesh(frame, radius, true), t, part);
    ++part;
  }
  for (const PointMass& mass : scene.point_masses) {
    const int number = part++;
    if (scene.body(mass.body).in_space()) continue;
    fem::FrameMotion frame;
    frame.origin = fem::point_motion(step.model.body(mass.body), step.x, mass.point).position;
    folder_.add_rigid_frame(mass.body + "_mass", disc_mesh(frame, drawn_radius(scene, mass), false),
                            t, number);
  }
}

void SnapshotWriter::add(const StepRecord& step) {
  // A snapshot shows the first step that reaches its time; no time step is shortened for it.
  const Scene& scene = shapes_.scene();
  const auto shown = static_cast<double>(snapshots_.size());
  if (shown >= n_ || step.abscissa < shown / (n_ - 1) * scene.time.end - 1e-9) return;
  io::PlaneFrame frame;
  frame.title = "t = " + io::to_text(step.abscissa, 4) + " s";
  for (size_t i = 0; i < scene.bodies.size(); ++i) {
    if (shapes_.is_designed(i)) {
      DesignedSurface s = shapes_.designed(step, i);
      frame.plates.push_back(
          {shapes_.grid_of(i).ny, std::move(s.mesh.points), std::move(s.density)});
    } else {
      Surface s = shapes_.deformed(step, i);
      const std::vector<double> full(s.mesh.quads.size(), 1.0);
      frame.plates.push_back({s.across, std::move(s.mesh.points), full});
    }
  }
  for (const RigidBody& body : scene.rigid_bodies)
    if (auto corners = drawn_corners(body, step.model, step.x); !corners.empty())
      frame.outlines.push_back(std::move(corners));
  snapshots_.push_back(std::move(frame));
}

void SnapshotWriter::archive(Archive& memory) { memory(snapshots_); }

}  // namespace flexmorph::cases
