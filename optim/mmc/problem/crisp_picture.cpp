#include "optim/mmc/problem/crisp_picture.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/components/outline.h"
#include "geometry/components/tdf.h"
#include "optim/mmc/problem/body_problem.h"
#include "optim/mmc/problem/finished_part.h"

namespace flexmorph::mmc {
namespace {

/// Largest length of the straight pieces of outlines, and their largest distance from the curved
/// outlines [cells].
constexpr double kPiece = 0.05, kOff = 1e-4;

using Entries = std::vector<Eigen::Triplet<double>>;

/// Assembles the derivatives of the area fractions by the motion of the outline of a union.
class OutlineMotion {
 public:
  OutlineMotion(const BodyProblem& problem, std::span<const Component> components)
      : problem_(problem),
        tdf_(problem.bands.back()),
        components_(components),
        cell_(std::min(problem.grid.dx(), problem.grid.dy())) {
    for (const Component& c : components)
      boxes_.push_back(bounding_box(c, tdf_.min_half_thickness, 0));
  }

  /// Adds the contribution of the outline of one component.
  void add(int index, Entries& out) const {
    const std::vector<Vec2> ring = outline_within(components_[static_cast<size_t>(index)],
                                                  tdf_.min_half_thickness, kOff * cell_);
    for (size_t k = 0; k < ring.size(); ++k) {
      const Vec2& a = ring[k];
      const Vec2 side = ring[(k + 1) % ring.size()] - a;
      const double length = side.norm();
      const int pieces = std::max(1, static_cast<int>(std::ceil(length / (kPiece * cell_))));
      for (int p = 0; p < pieces; ++p)
        add_piece(index, a + (p + 0.5) / pieces * side, length / pieces, out);
    }
  }

 private:
  void add_piece(int index, const Vec2& at, double length, Entries& out) const {
    const Grid& g = problem_.grid;
    const int i = static_cast<int>(std::floor((at.x() - g.x0) / g.dx())),
              j = static_cast<int>(std::floor((at.y() - g.y0) / g.dy()));
    if (i < 0 || i >= g.nx || j < 0 || j >= g.ny) return;
    const int cell = g.cell(i, j);
    if (!problem_.outside.empty() && problem_.outside[static_cast<size_t>(cell)]) return;
    if (is_fixed(at) || is_covered(index, at)) return;
    std::array<double, Component::kParameters> slope{};
    component_tdf(components_[static_cast<size_t>(index)], tdf_, at.x(), at.y(), slope.data());
    const double size = std::hypot(slope[0], slope[1]);  // φ depends on X - X0
    if (!(size > 0)) return;
    for (int q = 0; q < Component::kParameters; ++q)
      out.emplace_back(cell, Component::kParameters * index + q,
                       length * slope[static_cast<size_t>(q)] / (size * g.dx() * g.dy()));
  }

  bool is_fixed(const Vec2& at) const {
    const auto holds = [&](const std::vector<Vec2>& ring) { return contains({ring, {}}, at); };
    return std::any_of(problem_.solid.begin(), problem_.solid.end(), holds) ||
           std::any_of(problem_.empty.begin(), problem_.empty.end(), holds);
  }

  bool is_covered(int index, const Vec2& at) const {
    for (size_t c = 0; c < components_.size(); ++c) {
      if (static_cast<int>(c) == index || (at.array() < boxes_[c].lower.array()).any() ||
          (at.array() > boxes_[c].upper.array()).any())
        continue;
      if (component_tdf(components_[c], tdf_, at.x(), at.y(), nullptr) > 0) return true;
    }
    return false;
  }

  const BodyProblem& problem_;
  const TdfSettings& tdf_;
  std::span<const Component> components_;
  double cell_;
  std::vector<Box> boxes_;
};

}  // namespace

VectorXd CrispPicture::fractions(std::span<const Component> components) const {
  return fractions_of(*problem_, components);
}

VectorXd CrispPicture::of_part(std::span<const Component> components) const {
  return part_fractions(*problem_, components);
}

Eigen::SparseMatrix<double> CrispPicture::slopes(std::span<const Component> components) const {
  const OutlineMotion motion(*problem_, components);
  Entries entries;
  for (size_t c = 0; c < components.size(); ++c) motion.add(static_cast<int>(c), entries);
  Eigen::SparseMatrix<double> out(
      problem_->grid.n_cells(),
      Component::kParameters * static_cast<Eigen::Index>(components.size()));
  out.setFromTriplets(entries.begin(), entries.end());
  return out;
}

}  // namespace flexmorph::mmc
