#include "fem/dynamics/motion_archive.h"

namespace flexmorph::fem {
namespace {

enum class LineKind { fixed, driven, free };

LineKind kind_of(const MaterialLine& line) {
  return line.drive ? LineKind::driven : line.free ? LineKind::free : LineKind::fixed;
}

/// Returns lines of the given kinds and material coordinates. Only fixed lines next to the root are
/// inserted or removed; therefore driven and free lines are taken from the present grid, as the
/// root or by their index from the free end.
/// @throws Error (input) if the present grid has no such line.
std::vector<MaterialLine> lines_from(const LineGrid& grid, const std::vector<LineKind>& kinds,
                                     const std::vector<double>& locations) {
  const std::vector<MaterialLine>& old = grid.lines_m();
  std::vector<MaterialLine> out;
  for (size_t i = 0; i < kinds.size(); ++i) {
    const size_t behind = kinds.size() - i;
    const bool is_there = i == 0 || behind < old.size();
    if (kinds[i] == LineKind::fixed) {
      out.push_back({locations[i], {}, false});
    } else if (is_there && kind_of(i == 0 ? old[0] : old[old.size() - behind]) == kinds[i]) {
      out.push_back(i == 0 ? old[0] : old[old.size() - behind]);
      out.back().value = locations[i];
    } else {
      throw Error::input("checkpoint of a motion: it belongs to another mesh");
    }
  }
  return out;
}

}  // namespace

void archive(Archive& memory, Conditioning& c) { memory(c.t, c.condition, c.joints); }

void archive(Archive& memory, MeshEvent& e) {
  memory(e.time, e.body, e.change, e.before, e.after, e.momentum_before, e.momentum_after,
         e.tip_jump);
}

void archive(Archive& memory, MotionResult& r) {
  memory(r.smallest_step, r.largest_step, r.events, r.energy_error, r.energy_gain, r.start_change,
         r.alternation, r.cut, r.constraint_drift, r.velocity_drift, r.smallest_area_ratio,
         r.near_singular, r.redundant_joints);
}

void archive_meshes(Archive& memory, Workspace& model, std::span<const MovingRoot> moving_roots) {
  Workspace::CacheCheckpoint whole = model.cache_checkpoint();
  memory(whole.t, whole.lines);
  for (const MovingRoot& growth : moving_roots) {
    std::vector<LineKind> kinds;
    std::vector<double> locations;
    for (Body& body : model.bodies()) {
      if (body.name != growth.body) continue;
      const LineGrid& grid = grid_of(body);
      for (const MaterialLine& line : grid.lines_m()) kinds.push_back(kind_of(line));
      locations = grid.lines()[0];
      memory(kinds, locations);
      if (memory.is_restoring())
        model.set_element(body, grid.with_lines_m(lines_from(grid, kinds, locations), whole.t));
    }
  }
  std::vector<int> redundant = model.redundant_rows(), left_out = model.left_out_rows();
  memory(redundant, left_out);
  if (!memory.is_restoring()) return;
  if (!redundant.empty()) model.leave_out(redundant, left_out);
  model.restore_cache(whole);
}

}  // namespace flexmorph::fem
