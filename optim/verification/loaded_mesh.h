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

/// Nodes of a mesh at a location, with what share of an evenly spread force each has (sum 1).
struct LocationNodes {
  std::vector<std::pair<int, double>> shares;
  double held = 0;  ///< part of the material there that takes part in the statics
};

/// Loads and supports on one mesh of a part. Loads are in the order of their clamps.
class LoadedMesh {
 public:
  /// Lines and areas of locations that the mesh must follow.
  static std::vector<Segment> lines_of(const Loads& loads, std::span<const Region> regions,
                                       double small);
  /// @param locations  as chosen_locations() makes them; all references live longer
  LoadedMesh(const PartMesh& mesh, const fem::PlaneSection& section, const Loads& loads,
             std::span<const Location> locations, double small);

  /// The statics of the part; only where unsupported_load() is -1.
  const fem::TrianglePlate& plate() const { return *plate_; }
  fem::TrianglePlate& plate() { return *plate_; }
  /// Number of the load in Loads, by its row here.
  const std::vector<int>& order() const { return order_; }
  const std::vector<int>& clamps() const { return clamps_; }  ///< of the rows, ascending
  const std::vector<signed char>& omitted() const { return omitted_; }
  int n_omitted_pieces() const { return n_omitted_pieces_; }
  /// The first load that acts on nothing that is held, or -1.
  int unsupported_load() const { return unsupported_load_; }

  MatrixXd forces() const;      ///< (n_loads x n_unknowns), prescribed displacements included
  MatrixXd prescribed() const;  ///< (n_loads x 2 n_nodes); empty: all zero
  /// Forces at all nodes of a row (2 n_nodes), those at held ones included.
  VectorXd nodal_forces(int row) const;
  std::vector<fem::HeldUnknown> held(int row) const;
  /// Twice the energy of what keeps Loads::held_edge [J].
  /// @param u  (n_loads x n_unknowns)   @return (n_loads); zero without an edge
  VectorXd edge_energies(const MatrixXd& u) const;

 private:
  void sort_loads();
  void find_locations();
  void hold_at_pins();
  void find_balance();
  void omit_unsupported_pieces();
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
  std::vector<int> edge_;  // nodes on the held edge that take part, upwards
  std::vector<fem::NodeSpring> springs_;
  std::vector<signed char> omitted_;
  int n_omitted_pieces_ = 0, unsupported_load_ = -1;
  std::optional<PartBalance> balance_;
  std::unique_ptr<fem::TrianglePlate> plate_;
};

/// Lines or area of each location, whichever it is: only one of them is left.
std::vector<Location> chosen_locations(const Loads& loads, std::span<const Region> regions,
                                       double small);

}  // namespace flexmorph::verification
