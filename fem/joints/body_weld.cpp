#include "fem/body_weld.h"

#include <cmath>

#include "fem/joints/weld_rows.h"
#include "fem/line_grid.h"

namespace flexmorph::fem {
namespace {

/// Returns the product of complex numbers, which turns and scales the vector x by c.
Vec2 product(const Vec2& c, const Vec2& x) {
  return {c.x() * x.x() - c.y() * x.y(), c.x() * x.y() + c.y() * x.x()};
}

/// Returns the complex number that turns and scales the vector a of one body into the vector b of
/// the other, whose axis has the given angle. Components that are round-off of a right angle are
/// set to zero, so that the matrix needs no entries for them.
Vec2 turn_from(const Vec2& a, const Vec2& b, double angle) {
  const Vec2 back(a.x(), -a.y());
  Vec2 c = product({std::cos(angle), std::sin(angle)}, product(b, back)) / a.squaredNorm();
  for (int i = 0; i < 2; ++i)
    if (std::abs(c[i]) < 1e-14 * c.norm()) c[i] = 0;
  return c;
}

/// Rows of two kinds; x and z are vector unknowns:
///
///   Φ = x - Σ c ⊗ z                two rows, linear
///   Φ = (c ⊗ z) × x                one row, bilinear
class BodyWeld final : public Joint {
 public:
  BodyWeld(std::string name, EdgeLocation a, EdgeLocation b, double angle, WeldMode mode)
      : name_(std::move(name)), a_(std::move(a)), b_(std::move(b)), angle_(angle), mode_(mode) {
    if (!std::isfinite(angle)) refuse("its angle is not a finite number");
    if (a_.body == b_.body) refuse("a weld must join two different bodies");
  }

  std::unique_ptr<Joint> clone() const override { return std::make_unique<BodyWeld>(*this); }
  std::string name() const override { return name_; }
  int size() const override { return static_cast<int>(2 * equal_.size() + parallel_.size()); }

  void bind(std::span<const BodyView> bodies) override {
    const Edge a = edge_of(bodies, a_), b = edge_of(bodies, b_);
    equal_.clear();
    parallel_.clear();
    if (a.is_beam() && b.is_beam())
      join_beams(a, b);
    else if (a.is_beam())
      put_on_beam(a, b, angle_);
    else if (b.is_beam())
      put_on_beam(b, a, -angle_);
    else
      join_plates(a, b);
  }

  void evaluate(double, const VectorXd& q, const VectorXd& v, ConstraintRows& rows) const override {
    rows.value.resize(size());
    rows.rate.setZero(size());
    rows.acceleration.setZero(size());
    rows.jacobian.clear();
    int i = 0;
    for (const Equal& e : equal_) {
      rows.value.segment<2>(i) = q.segment<2>(e.x);
      for (int k = 0; k < 2; ++k) rows.jacobian.emplace_back(i + k, e.x + k, 1.0);
      for (const Turned& z : e.of) {
        rows.value.segment<2>(i) -= product(z.c, q.segment<2>(z.dof));
        for (int k = 0; k < 2; ++k) {
          if (z.c.x() != 0) rows.jacobian.emplace_back(i + k, z.dof + k, -z.c.x());
          if (z.c.y() != 0)
            rows.jacobian.emplace_back(i + k, z.dof + 1 - k, k == 0 ? z.c.y() : -z.c.y());
        }
      }
      i += 2;
    }
    for (const Parallel& p : parallel_) {
      const Vec2 z = product(p.z.c, q.segment<2>(p.z.dof)), x = q.segment<2>(p.x);
      const Vec2 by_z = transposed(p.z.c, {x.y(), -x.x()});
      rows.value[i] = cross(z, x);
      rows.acceleration[i] = -2 * cross(product(p.z.c, v.segment<2>(p.z.dof)), v.segment<2>(p.x));
      for (int k = 0; k < 2; ++k) rows.jacobian.emplace_back(i, p.z.dof + k, by_z[k]);
      rows.jacobian.emplace_back(i, p.x, -z.y());
      rows.jacobian.emplace_back(i, p.x + 1, z.x());
      ++i;
    }
  }

  void add_stiffness(double, const VectorXd&, const VectorXd& lambda,
                     std::vector<Eigen::Triplet<double>>& out) const override {
    auto i = static_cast<Eigen::Index>(2 * equal_.size());
    for (const Parallel& p : parallel_) {
      Eigen::Matrix2d by;  // derivative of the row by z (rows) and by x (columns)
      by << -p.z.c.y(), p.z.c.x(), -p.z.c.x(), -p.z.c.y();
      by *= lambda[i++];
      for (int k = 0; k < 2; ++k)
        for (int l = 0; l < 2; ++l) {
          out.emplace_back(p.z.dof + k, p.x + l, by(k, l));
          out.emplace_back(p.x + l, p.z.dof + k, by(k, l));
        }
    }
  }

 private:
  /// The product c ⊗ z with the vector z whose first unknown is dof.
  struct Turned {
    int dof;
    Vec2 c;
  };
  struct Equal {
    int x;
    std::vector<Turned> of;
  };
  struct Parallel {
    int x;
    Turned z;
  };

  /// One of the two edges in the model.
  struct Edge {
    std::vector<NodeVectors> nodes;
    EdgeVectors reference;
    int first_dof;

    bool is_beam() const { return nodes.size() == 1; }
    int dof(int vector) const { return first_dof + 2 * vector; }
  };

  static double cross(const Vec2& x, const Vec2& y) { return x.x() * y.y() - x.y() * y.x(); }
  static Vec2 transposed(const Vec2& c, const Vec2& x) { return product({c.x(), -c.y()}, x); }

  [[noreturn]] void refuse(const std::string& why) const {
    throw Error::input("joint '" + name_ + "': " + why);
  }

  Edge edge_of(std::span<const BodyView> bodies, const EdgeLocation& location) const {
    const BodyView& body = find_body(bodies, name_, location.body);
    const Element& element = *body.element;
    if (element.is_rigid()) refuse("'" + location.body + "' is a rigid body: it has no edges");
    if (element.dim() != 2) refuse("three-dimensional bodies cannot be welded to each other");
    const std::vector<NodeVectors> nodes = element.edge(location.edge);
    for (const NodeVectors& node : nodes) {
      if (node.material.x() != nodes.front().material.x())
        refuse("edge '" + location.edge + "' runs along '" + location.body +
               "'; a weld needs an edge across the body");
      if (node.moving || is_free(element, node.material.x()))
        refuse("edge '" + location.edge + "' of '" + location.body +
               "' moves through the material");
    }
    return {nodes, edge_vectors(element, nodes), body.first_dof};
  }

  /// Returns true if the m-line at that material coordinate is an unknown.
  static bool is_free(const Element& element, double material) {
    const auto* grid = dynamic_cast<const LineGrid*>(&element);
    for (int i = 0; grid && i <= grid->n_m(); ++i)
      if (grid->line_m(i).value == material) return grid->lines_m()[static_cast<size_t>(i)].free;
    return false;
  }

  void join_beams(const Edge& a, const Edge& b) {
    const NodeVectors &m = a.nodes[0], &n = b.nodes[0];
    equal_.push_back({b.dof(n.r), {{a.dof(m.r), {1, 0}}}});
    const Turned section{a.dof(m.r_n), turn_from(a.reference.r_n, b.reference.r_n, angle_)};
    if (mode_ == WeldMode::partial) {
      parallel_.push_back({b.dof(n.r_n), section});
      return;
    }
    if (mode_ == WeldMode::direction)
      refuse("the weld of two beams must be \"partial\", \"edge\" or \"full\"");
    equal_.push_back({b.dof(n.r_n), {section}});
    if (mode_ == WeldMode::full)
      equal_.push_back(
          {b.dof(n.r_m), {{a.dof(m.r_m), turn_from(a.reference.r_m, b.reference.r_m, angle_)}}});
  }

  void join_plates(const Edge& a, const Edge& b) {
    if (mode_ != WeldMode::edge && mode_ != WeldMode::full)
      refuse("the weld of two plates must be \"edge\" or \"full\"");
    if (std::abs(std::sin(angle_)) > 1e-9)
      refuse("the angle between two welded plates must be 0 or 180 degrees");
    const double c = std::cos(angle_) > 0 ? 1 : -1;
    if (a.nodes.size() != b.nodes.size())
      refuse("the plates have " + std::to_string(a.nodes.size() - 1) + " and " +
             std::to_string(b.nodes.size() - 1) + " elements across");
    for (size_t k = 0; k < a.nodes.size(); ++k) {
      const NodeVectors& m = a.nodes[k];
      const NodeVectors& n = b.nodes[c > 0 ? k : a.nodes.size() - 1 - k];
      const double width = a.nodes.back().material.y() - a.nodes.front().material.y();
      if (std::abs(n.material.y() - c * m.material.y()) > 1e-9 * width)
        refuse("the nodes of the plates do not coincide");
      if ((m.r_n < 0) != (n.r_n < 0) || (m.r_m < 0) != (n.r_m < 0) || (m.r_mn < 0) != (n.r_mn < 0))
        refuse("the plates have elements of different types");
      const auto same = [&](int vector_a, int vector_b, double factor) {
        if (vector_a >= 0) equal_.push_back({b.dof(vector_b), {{a.dof(vector_a), {factor, 0}}}});
      };
      same(m.r, n.r, 1);
      same(m.r_n, n.r_n, c);
      if (mode_ == WeldMode::edge) continue;
      same(m.r_m, n.r_m, c);
      same(m.r_mn, n.r_mn, 1);
    }
  }

  /// @param angle  angle of the axis of the plate relative to the axis of the beam
  void put_on_beam(const Edge& beam, const Edge& plate, double angle) {
    if (mode_ != WeldMode::edge) refuse("the weld of a plate and a beam must be \"edge\"");
    const NodeVectors& end = beam.nodes[0];
    const Turned across{beam.dof(end.r_n),
                        turn_from(beam.reference.r_n, plate.reference.r_n, angle)};
    for (const NodeVectors& node : plate.nodes) {
      Equal& r = equal_.emplace_back(Equal{plate.dof(node.r), {{beam.dof(end.r), {1, 0}}}});
      if (const double y = node.material.y(); y != 0) r.of.push_back({across.dof, y * across.c});
      if (node.r_n >= 0) equal_.push_back({plate.dof(node.r_n), {across}});
    }
  }

  std::string name_;
  EdgeLocation a_, b_;
  double angle_;
  WeldMode mode_;
  std::vector<Equal> equal_;
  std::vector<Parallel> parallel_;
};

}  // namespace

std::unique_ptr<Joint> make_body_weld(std::string name, EdgeLocation a, EdgeLocation b,
                                      double angle, WeldMode mode) {
  return std::make_unique<BodyWeld>(std::move(name), std::move(a), std::move(b), angle, mode);
}

}  // namespace flexmorph::fem
