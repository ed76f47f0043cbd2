#pragma once

#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "fem/triangles/triangle_plate.h"
#include "optim/verification/balance.h"
#include "optim/verification/loads.h"

namespace flexmorph::verification {

/// The nodes of a mesh at one location.
struct LocationNodes {
  std::vector<std::pair<int, double>> shares;  ///< Nodes and their shares of a force (sum 1) [-].
  double held = 0;  ///< Fraction of the material at the location that takes part in the statics.
};

/// Loads and supports on one mesh of a part. Its rows are the loads, sorted by their clamps from
/// the largest x to the smallest.
class LoadedMesh {
 public:
  /// Returns the segments that the mesh must follow: the lines and the borders of the areas of all
  /// locations, and the lines of the clamps.
  /// @param small  largest distance of points that count as lying on a line [m]
  static std::vector<Segment> lines_of(const Loads& loads, std::span<const Region> regions,
                                       double small);
  /// Applies the loads to a mesh. The mesh, the loads and the locations must outlive this object.
  /// @param locations  locations of the loads as chosen_locations() returns them
  /// @param small      largest distance of points that count as lying on a line [m]
  LoadedMesh(const PartMesh& mesh, const fem::PlaneSection& section, const Loads& loads,
             std::span<const Location> locations, double small);

  /// Returns the static analysis of the part; it exists only if unsupported_load() is -1.
  const fem::TrianglePlate& plate() const { return *plate_; }
  fem::TrianglePlate& plate() { return *plate_; }
  /// Returns the index in Loads::loads of each row (n_loads).
  const std::vector<int>& order() const { return order_; }
  /// Returns the index of the clamp line of each row (n_loads), ascending; 0 for loads without one.
  const std::vector<int>& clamps() const { return clamps_; }
  /// Returns 1 for triangles that take no part in the statics, 0 for the others (n_triangles).
  const std::vector<signed char>& omitted() const { return omitted_; }
  /// Returns the number of connected regions that take no part in the statics.
  int n_omitted_regions() const { return n_omitted_regions_; }
  /// Returns the index in Loads::loads of the first load that acts on unsupported material, or -1.
  int unsupported_load() const { return unsupported_load_; }

  /// Returns the right-hand sides (n_loads x n_unknowns) [N], including the effect of prescribed
  /// displacements.
  MatrixXd forces() const;
  /// Returns the prescribed displacements (n_loads x 2 n_nodes) [m]; empty if all are zero.
  MatrixXd prescribed() const;
  /// Returns the forces of a row at all nodes (2 n_nodes) [N], including those at held nodes.
  VectorXd nodal_forces(int row) const;
  /// Returns the displacements that are held in a row, including those behind its clamp.
  std::vector<fem::HeldUnknown> held(int row) const;
  /// Returns twice the energy of the springs at Loads::held_edge (n_loads) [J]; zero without an
  /// edge.
  /// @param u  displacements (n_loads x n_unknowns) [m]
  VectorXd edge_energies(const MatrixXd& u) const;

 private:
  void sort_loads();
  void find_locations();
  void hold_at_pins();
  void find_balance();
  void omit_unsupported_regions();
  void find_edge();
  double held_end_stretch(std::size_t row) const;
  std::vector<std::pair<int, Vec2>> forces_at_nodes(const Force& force) const;
  bool is_held(int piece) const;
  void add_inertia(std::span<const int> rows, MatrixXd& at_nodes) const;

  const PartMesh& mesh_;
  fem::PlaneSection section_;
  const Loads& loads_;
  std::span<const Location> locations_;
  double small_;
  std::vector<int> order_, clamps_;
  std::vector<double> clamp_lines_;
  std::vector<LocationNodes> at_locations_;
  std::vector<fem::HeldUnknown> held_;
  std::vector<int> edge_;  // nodes on the held edge that take part, by ascending y
  std::vector<fem::NodeSpring> springs_;
  std::vector<signed char> omitted_;
  int n_omitted_regions_ = 0, unsupported_load_ = -1;
  std::optional<PartBalance> balance_;
  std::unique_ptr<fem::TrianglePlate> plate_;
};

/// Returns the locations of the loads, each reduced to either its lines or its area: to its lines
/// if the outline of a region runs along one of them, otherwise to its area.
std::vector<Location> chosen_locations(const Loads& loads, std::span<const Region> regions,
                                       double small);

}  // namespace flexmorph::verification
