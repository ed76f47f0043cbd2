#include <algorithm>

#include "fem/body_joints.h"
#include "fem/joints/weld_rows.h"

namespace flexmorph::fem {
namespace {

/// Rows of two kinds. An entry of the plate equals a coordinate of the frame,
///
///   Φ = q_i - g · (p, e),   g (4) constant
///
/// or a vector x of the plate has no component along a direction n of the frame: Φ = n · x,
/// bilinear.
class EdgeWeld final : public Joint {
 public:
  EdgeWeld(std::string name, std::string plate, std::string edge, MarkerLocation frame,
           WeldMode mode)
      : name_(std::move(name)),
        plate_(std::move(plate)),
        edge_(std::move(edge)),
        frame_(std::move(frame)),
        mode_(mode) {}

  std::unique_ptr<Joint> clone() const override { return std::make_unique<EdgeWeld>(*this); }
  std::string name() const override { return name_; }
  int size() const override { return static_cast<int>(fixed_.size() + along_.size()); }

  void bind(std::span<const BodyView> bodies) override {
    frame_.bind(bodies, "joint '" + name_ + "'", true);
    const BodyView& body = find_body(bodies, name_, plate_);
    const Element& element = *body.element;
    const int dim = element.dim();
    const std::vector<NodeVectors> nodes = element.edge(edge_);
    const auto on_line = [&](const NodeVectors& node) {
      return node.material.x() == nodes.front().material.x();
    };
    if (!std::all_of(nodes.begin(), nodes.end(), on_line))
      throw Error::input("joint '" + name_ + "': edge '" + edge_ +
                         "' runs along the plate; a weld needs an edge across the plate");
    fixed_.clear();
    along_.clear();
    const WeldRows rows = weld_rows(element, nodes, mode_, name_);
    for (const WeldRows::Fixed& x : rows.fixed)
      fix(body.first_dof + dim * x.vector, x.moves, x.local);
    for (const int vector : rows.flat)  // the frame turns in the plane z = 0
      fixed_.push_back({body.first_dof + dim * vector + 2, Eigen::Vector4d::Zero()});
    for (const WeldRows::Along& x : rows.along)
      along_.push_back({body.first_dof + dim * x.vector, x.normal});
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
    for (const Along& along : along_) {
      const Vec2 n = along.normal(f.y.tail<2>()), n_t = along.normal(f.rate.tail<2>());
      const Vec2 x = q.segment<2>(along.dof), x_t = v.segment<2>(along.dof);
      rows.value[i] = n.dot(x);
      rows.rate[i] = 0;
      rows.acceleration[i] = -2 * n_t.dot(x_t);
      rows.jacobian.emplace_back(i, along.dof, n.x());
      rows.jacobian.emplace_back(i, along.dof + 1, n.y());
      for (size_t k = 0; k < frame_.dofs().size(); ++k)
        if (turns(k))
          rows.jacobian.emplace_back(i, frame_.dofs()[k], along.normal(column(k).tail<2>()).dot(x));
      ++i;
    }
  }

  void add_stiffness(double, const VectorXd&, const VectorXd& lambda,
                     std::vector<Eigen::Triplet<double>>& out) const override {
    auto i = static_cast<Eigen::Index>(fixed_.size());
    for (const Along& along : along_) {
      for (size_t k = 0; k < frame_.dofs().size(); ++k) {
        if (!turns(k)) continue;
        const Vec2 by_x = lambda[i] * along.normal(column(k).tail<2>());
        for (int c = 0; c < 2; ++c) {
          out.emplace_back(along.dof + c, frame_.dofs()[k], by_x[c]);
          out.emplace_back(frame_.dofs()[k], along.dof + c, by_x[c]);
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

  struct Along {
    int dof;     // first unknown of the vector
    Vec2 local;  // direction without a component of the vector, in the frame

    /// Returns this direction in the world for a frame with axis 1 = e; linear in e.
    Vec2 normal(const Vec2& e) const {
      return {local.x() * e.x() - local.y() * e.y(), local.x() * e.y() + local.y() * e.x()};
    }
  };

  /// Adds the rows by which the vector at `dof` equals moves p + local.x e₁ + local.y e₂, with e₁ =
  /// e, e₂ = (-e_y, e_x).
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
  std::vector<Along> along_;
};

}  // namespace

std::unique_ptr<Joint> make_edge_weld(std::string name, std::string plate, std::string edge,
                                      MarkerLocation frame, WeldMode mode) {
  return std::make_unique<EdgeWeld>(std::move(name), std::move(plate), std::move(edge),
                                    std::move(frame), mode);
}

}  // namespace flexmorph::fem
