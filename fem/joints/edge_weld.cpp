#include <algorithm>

#include "fem/body_joints.h"

namespace flexmorph::fem {
namespace {

/// Rows of two kinds. An entry of the plate equals one coordinate of the frame,
///
///   Φ = q_i - g · (p, e),   g (4) constant
///
/// or a vector x of the plate keeps to axis 1: Φ = e × x = x · e₂, bilinear.
class EdgeWeld final : public Joint {
 public:
  EdgeWeld(std::string name, std::string plate, std::string edge, MarkerPlace frame, WeldMode mode)
      : name_(std::move(name)),
        plate_(std::move(plate)),
        edge_(std::move(edge)),
        frame_(std::move(frame)),
        mode_(mode) {}

  std::string name() const override { return name_; }
  int size() const override { return static_cast<int>(fixed_.size() + along_.size()); }

  void bind(std::span<const BodyView> bodies) override {
    frame_.bind(bodies, "joint '" + name_ + "'", true);
    const auto& [body, element_at, first_dof] = find_body(bodies, name_, plate_);
    const Element& element = *element_at;
    const int dim = element.dim();
    const std::vector<NodeVectors> nodes = element.edge(edge_);
    const auto on_line = [&](const NodeVectors& node) {
      return node.material.x() == nodes.front().material.x();
    };
    if (!std::all_of(nodes.begin(), nodes.end(), on_line))
      throw Error::input("joint '" + name_ + "': edge '" + edge_ +
                         "' runs along the plate; a weld is at an edge across it");
    fixed_.clear();
    along_.clear();
    for (const NodeVectors& node : nodes) {
      const auto dof = [&, first = first_dof](int vector) { return first + dim * vector; };
      fix(dof(node.r), 1, {0, node.material.y()});
      fix(dof(node.r_n), 0, {0, 1});
      for (const int vector : {node.r_m, node.r_mn}) {
        if (vector < 0 || mode_ == WeldMode::edge) continue;
        if (mode_ == WeldMode::direction)
          along_.push_back(dof(vector));
        else
          fix(dof(vector), 0, {vector == node.r_m ? 1.0 : 0.0, 0});
      }
      if (dim == 3)  // the frame turns in the plane z = 0
        for (const int vector : {node.r, node.r_n, node.r_m, node.r_mn})
          if (vector >= 0) fixed_.push_back({dof(vector) + 2, Eigen::Vector4d::Zero()});
    }
  }

  void evaluate(double t, const VectorXd& q, const VectorXd& v,
                ConstraintRows& rows) const override {
    const MarkerMotion f = frame_.evaluate(t, q, v);
    rows.value.resize(size());
    rows.rate.resize(size());
    rows.acceleration.resize(size());
    rows.jacobian.clear();
    int i = 0;
    for (const Fixed& x : fixed_) {
      rows.value[i] = q[x.dof] - x.g.dot(f.y);
      rows.rate[i] = -x.g.dot(f.y_t);
      rows.acceleration[i] = x.g.dot(f.convective);
      rows.jacobian.emplace_back(i, x.dof, 1.0);
      for (size_t k = 0; k < frame_.dofs().size(); ++k)
        if (reads(x.g, k)) rows.jacobian.emplace_back(i, frame_.dofs()[k], -x.g.dot(column(k)));
      ++i;
    }
    const Vec2 e = f.y.tail<2>(), e_t = f.rate.tail<2>();
    for (const int dof : along_) {
      const Vec2 x = q.segment<2>(dof), x_t = v.segment<2>(dof);
      rows.value[i] = cross(e, x);
      rows.rate[i] = 0;
      rows.acceleration[i] = -2 * cross(e_t, x_t);
      rows.jacobian.emplace_back(i, dof, -e.y());
      rows.jacobian.emplace_back(i, dof + 1, e.x());
      for (size_t k = 0; k < frame_.dofs().size(); ++k)
        if (turns(k))
          rows.jacobian.emplace_back(i, frame_.dofs()[k], cross(column(k).tail<2>(), x));
      ++i;
    }
  }

  void add_stiffness(double, const VectorXd&, const VectorXd& lambda,
                     std::vector<Eigen::Triplet<double>>& out) const override {
    auto i = static_cast<Eigen::Index>(fixed_.size());
    for (const int dof : along_) {
      for (size_t k = 0; k < frame_.dofs().size(); ++k) {
        if (!turns(k)) continue;
        const Vec2 e = column(k).tail<2>();
        const double by_x[2] = {-lambda[i] * e.y(), lambda[i] * e.x()};
        for (int c = 0; c < 2; ++c) {
          out.emplace_back(dof + c, frame_.dofs()[k], by_x[c]);
          out.emplace_back(frame_.dofs()[k], dof + c, by_x[c]);
        }
      }
      ++i;
    }
  }

 private:
  struct Fixed {
    int dof;
    Eigen::Vector4d g;
  };

  static double cross(const Vec2& x, const Vec2& y) { return x.x() * y.y() - x.y() * y.x(); }

  /// Vector at `dof` equals moves p + local.x e₁ + local.y e₂, e₁ = e, e₂ = (-e_y, e_x).
  void fix(int dof, double moves, const Vec2& local) {
    fixed_.push_back({dof, {moves, 0, local.x(), -local.y()}});
    fixed_.push_back({dof + 1, {0, moves, local.y(), local.x()}});
  }

  Eigen::Vector4d column(size_t k) const {
    return frame_.block().col(static_cast<Eigen::Index>(k));
  }
  bool reads(const Eigen::Vector4d& g, size_t k) const {
    for (int i = 0; i < 4; ++i)
      if (g[i] != 0 && frame_.depends(i, k)) return true;
    return false;
  }
  bool turns(size_t k) const { return frame_.depends(2, k) || frame_.depends(3, k); }

  std::string name_, plate_, edge_;
  Marker frame_;
  WeldMode mode_;
  std::vector<Fixed> fixed_;
  std::vector<int> along_;  // first unknown of vectors that keep to e₁
};

}  // namespace

std::unique_ptr<Joint> make_edge_weld(std::string name, std::string plate, std::string edge,
                                      MarkerPlace frame, WeldMode mode) {
  return std::make_unique<EdgeWeld>(std::move(name), std::move(plate), std::move(edge),
                                    std::move(frame), mode);
}

}  // namespace flexmorph::fem
