#include "cases/output/run_folder.h"

#include <cmath>

#include "cases/scene/elements/row.h"
#include "io/files.h"

namespace flexmorph::cases {

std::string numbered(const std::string& stem, int number, const std::string& ending) {
  std::string digits = io::to_text(number);
  return stem + std::string(digits.size() < 5 ? 5 - digits.size() : 0, '0') + digits + ending;
}

RunFolder::RunFolder(std::string path, const Scene& scene, bool beside, Begin begin)
    : folder_(std::move(path), begin),
      scene_(scene),
      iterations_(*this, "design/iterations.pvd"),
      fields_(*this, "design/fields.pvd"),
      components_(*this, "design/components.pvd"),
      motion_(*this, "motion/motion.pvd"),
      writer_(beside) {
  if (!scene.designs.empty()) begin_history(begin);
}

void RunFolder::FrameIndex::add(double time, const std::string& file, int part) {
  if (!series_) series_.emplace(folder_.file(name_));
  series_->add(time, file, part);
}

void RunFolder::FrameIndex::drop(const std::string& file) {
  if (series_) series_->drop(file);
}

void RunFolder::write_frame(std::function<void()> task) {
  writer_.then([this, task = std::move(task)] {
    try {
      task();
    } catch (const Error& error) {
      if (lost_frames_++ == 0) why_lost_ = error.what();
    }
  });
}

std::string RunFolder::lost_frames() {
  writer_.wait();
  if (lost_frames_ == 0) return "";
  return io::to_text(lost_frames_) + (lost_frames_ == 1 ? " frame" : " frames") +
         " for ParaView could not be written: " + why_lost_;
}

double RunFolder::take_output_seconds() { return output_seconds_.exchange(0); }

void RunFolder::finish() {
  writer_.wait();
  // Frames are left out because they are many and only intermediate pictures.
  for (const std::string& name : folder_.files())
    if (!name.starts_with("design/") && !name.starts_with("motion/"))
      io::sync_file(path() + "/" + name);
}

namespace {

/// A field that owns a copy of its values.
struct OwnField {
  std::string name;
  std::vector<double> values;
  int components;
  std::string unit;
};

std::vector<OwnField> copies_of(std::span<const io::Field> fields) {
  std::vector<OwnField> out;
  for (const io::Field& f : fields)
    out.push_back({f.name, {f.values.begin(), f.values.end()}, f.components, f.unit});
  return out;
}

std::vector<io::Field> views_of(const std::vector<OwnField>& fields) {
  std::vector<io::Field> out;
  for (const OwnField& f : fields)
    out.push_back({.name = f.name, .values = f.values, .components = f.components, .unit = f.unit});
  return out;
}

}  // namespace

void RunFolder::write_part(const std::string& body, FramePart part) {
  const std::vector<double> number(part.mesh.quads.size(), part.number);
  part.cells.push_back({"body", number});
  write_frame([this, file = numbered("motion_" + body + "_", ++motion_frames_, ".vtu"),
               mesh = part.mesh, of_cells = copies_of(part.cells),
               of_points = copies_of(part.points), time = part.time, n = part.number] {
    io::write_quad_mesh(folder_.file("motion/" + file), mesh, views_of(of_cells),
                        views_of(of_points));
    motion_.add(time, file, n);
    frames_.push_back({file, time, n});
  });
}

void RunFolder::archive_frames(Archive& memory) {
  writer_.wait();
  memory(motion_frames_, frames_, lost_frames_, why_lost_);
  size_t n = shapes_.size();
  memory(n);
  shapes_.resize(n);
  for (io::SurfaceFrame& shape : shapes_)
    memory(shape.title, shape.mesh.dimension, shape.mesh.points, shape.mesh.quads, shape.values);
  if (memory.is_restoring())
    for (const Frame& frame : frames_) motion_.add(frame.time, frame.file, frame.part);
}

std::vector<std::string> RunFolder::frames() const {
  std::vector<std::string> out;
  for (const Frame& frame : frames_) out.push_back("motion/" + frame.file);
  return out;
}

namespace {

/// Returns the fields of the deformation, by which ParaView can displace a mesh, and of the rigid
/// motion.
std::vector<io::Field> displacement_fields(std::span<const double> deformation,
                                           std::span<const double> motion, int dim) {
  return {{.name = "displacement", .values = deformation, .components = dim, .unit = "m"},
          {.name = "motion", .values = motion, .components = dim, .unit = "m"}};
}

}  // namespace

void RunFolder::add_surface_frame(const std::string& body, const Surface& surface, double time,
                                  int part) {
  const int dim = surface.mesh.dimension;
  std::vector<io::Field> cells = {
      {.name = "strain_energy_per_area", .values = surface.energy, .unit = "J/m^2"}};
  if (!surface.strain.empty())
    cells.push_back({.name = "elastic_strain", .values = surface.strain, .components = 3});
  if (!surface.stress.empty())
    cells.push_back({.name = "von_mises", .values = surface.stress, .unit = "Pa"});
  write_part(body, {surface.mesh, std::move(cells),
                    displacement_fields(surface.displacement, surface.motion, dim), time, part});
  if (part == 0 && surface.mesh.dimension == 3)
    shapes_.push_back(
        {(scene_.statics ? "step " : "t = ") + io::to_text(time, 4) + (scene_.statics ? "" : " s"),
         surface.mesh, surface.energy});
}

void RunFolder::add_rigid_frame(const std::string& name, const io::QuadMesh& mesh, double time,
                                int part) {
  write_part(name, {mesh, {}, {}, time, part});
}

void RunFolder::add_motion_frame(const std::string& body, const DesignedSurface& surface,
                                 double time, int part) {
  write_part(body, {surface.mesh,
                    {{.name = "density", .values = surface.density},
                     {.name = "strain_energy_per_area", .values = surface.energy, .unit = "J/m^2"},
                     {.name = "von_mises", .values = surface.stress, .unit = "Pa"}},
                    displacement_fields(surface.displacement, surface.motion, 2),
                    time,
                    part});
}

std::vector<io::SurfaceFrame> RunFolder::shapes(size_t most) const {
  if (shapes_.size() <= most) return shapes_;
  std::vector<io::SurfaceFrame> out;
  for (size_t k = 0; k < most; ++k) out.push_back(shapes_[k * (shapes_.size() - 1) / (most - 1)]);
  return out;
}

void RunFolder::write_text(const std::string& name, const std::string& text) {
  io::write_file(folder_.file(name), text, io::Sync::now);
}

}  // namespace flexmorph::cases
