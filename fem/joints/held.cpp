#include <algorithm>

#include "fem/joint.h"

namespace flexmorph::fem {
namespace {

int vector_of(const NodeVectors& node, NodeVector kind) {
  switch (kind) {
    case NodeVector::r:
      return node.r;
    case NodeVector::r_m:
      return node.r_m;
    case NodeVector::r_n:
      return node.r_n;
    case NodeVector::r_mn:
      return node.r_mn;
  }
  return -1;
}

/// One row per held entry of a vector unknown: q_i - value = 0.
class Hold final : public Joint {
 public:
  Hold(std::string name, std::string body, std::vector<Held> held)
      : name_(std::move(name)), body_(std::move(body)), held_(std::move(held)) {}

  std::unique_ptr<Joint> clone() const override { return std::make_unique<Hold>(*this); }
  std::string name() const override { return name_; }
  int size() const override { return static_cast<int>(rows_.size()); }

  void bind(std::span<const BodyView> bodies) override {
    const BodyView& body = find_body(bodies, name_, body_);
    const MatrixXd reference = body.element->reference();
    rows_.clear();
    for (const Held& held : held_) {
      check(held, body.element->dim());
      for (const NodeVectors& node : nodes(held.at, *body.element)) {
        const int vector = vector_of(node, held.vector);
        if (vector < 0) continue;  // h12 has no r_mn
        if (node.moving)
          throw Error::input("joint '" + name_ + "': a material line that moves cannot be fixed");
        for (const int c : held.components)
          rows_.push_back({body.first_dof + body.element->dim() * vector + c,
                           held.value.size() > 0 ? held.value[c] : reference(vector, c)});
      }
    }
    merge();
  }

  void evaluate(double, const VectorXd& q, const VectorXd&, ConstraintRows& rows) const override {
    rows.value.resize(size());
    rows.rate = VectorXd::Zero(size());
    rows.acceleration = VectorXd::Zero(size());
    rows.jacobian.clear();
    for (int i = 0; i < size(); ++i) {
      const Row& row = rows_[static_cast<size_t>(i)];
      rows.value[i] = q[row.dof] - row.value;
      rows.jacobian.emplace_back(i, row.dof, 1.0);
    }
  }

 private:
  struct Row {
    int dof;
    double value;
  };

  void check(const Held& held, int dim) const {
    if (held.components.empty()) throw Error::input("joint '" + name_ + "': no component is fixed");
    for (const int c : held.components)
      if (c < 0 || c >= dim)
        throw Error::input("joint '" + name_ + "': component " + std::to_string(c) +
                           " does not exist; the body has " + std::to_string(dim) + " dimensions");
    if (held.value.size() != 0 && (held.value.size() != dim || !held.value.allFinite()))
      throw Error::input("joint '" + name_ + "': a fixed value must have " + std::to_string(dim) +
                         " finite entries");
  }

  std::vector<NodeVectors> nodes(const HoldLocation& at, const Element& element) const {
    if (!at.edge.empty()) return element.edge(at.edge);
    std::vector<NodeVectors> out;
    // The tolerance is a millionth of the element size, because case files contain rounded
    // coordinates.
    for (const NodeVectors& node : element.nodes()) {
      const Vec2 slack(1e-6 * element.scale(node.r_m), 1e-6 * element.scale(node.r_n));
      const Vec2 below = at.low - slack, above = at.high + slack;
      if ((node.material.array() >= below.array()).all() &&
          (node.material.array() <= above.array()).all())
        out.push_back(node);
    }
    if (out.empty())
      throw Error::input("joint '" + name_ + "': there is no node of body '" + body_ + "' in [" +
                         std::to_string(at.low.x()) + ", " + std::to_string(at.high.x()) + "] x [" +
                         std::to_string(at.low.y()) + ", " + std::to_string(at.high.y()) + "] m");
    return out;
  }

  /// Keeps each entry once, because edges share their corners. The rows are sorted, so that the
  /// result does not depend on the order of the list.
  void merge() {
    std::stable_sort(rows_.begin(), rows_.end(),
                     [](const Row& x, const Row& y) { return x.dof < y.dof; });
    for (size_t i = 0; i + 1 < rows_.size(); ++i)
      if (rows_[i].dof == rows_[i + 1].dof && rows_[i].value != rows_[i + 1].value)
        throw Error::input("joint '" + name_ + "': one degree of freedom is fixed at two values, " +
                           std::to_string(rows_[i].value) + " and " +
                           std::to_string(rows_[i + 1].value));
    const auto same = [](const Row& x, const Row& y) { return x.dof == y.dof; };
    rows_.erase(std::unique(rows_.begin(), rows_.end(), same), rows_.end());
  }

  std::string name_, body_;
  std::vector<Held> held_;
  std::vector<Row> rows_;
};

/// Position gradients along and across an edge, and the direction across it.
struct EdgeSlopes {
  NodeVector along, across;
  int direction;
};

EdgeSlopes slopes(const std::string& edge) {
  if (edge == "root" || edge == "free_end") return {NodeVector::r_n, NodeVector::r_m, 0};
  return {NodeVector::r_m, NodeVector::r_n, 1};
}

}  // namespace

std::vector<Held> clamped_edge(const std::string& edge, WeldMode mode) {
  const EdgeSlopes s = slopes(edge);
  std::vector<int> across;  // held components of the position gradient across the edge
  for (const int c : {0, 1, 2})
    if (mode == WeldMode::full || c == 2 || (mode == WeldMode::direction && c != s.direction))
      across.push_back(c);
  return {{{.edge = edge}, NodeVector::r, {0, 1, 2}, {}},
          {{.edge = edge}, s.along, {0, 1, 2}, {}},
          {{.edge = edge}, s.across, across, {}},
          {{.edge = edge}, NodeVector::r_mn, across, {}}};
}

std::vector<Held> supported_edge(const std::string& edge) {
  return {{{.edge = edge}, NodeVector::r, {2}, {}}, {{.edge = edge}, slopes(edge).along, {2}, {}}};
}

std::vector<Held> symmetry_edge(const std::string& edge) {
  const EdgeSlopes s = slopes(edge);
  const std::vector<int> even = {1 - s.direction, 2};  // components that are even across the edge
  return {{{.edge = edge}, NodeVector::r, {s.direction}, {}},
          {{.edge = edge}, s.along, {s.direction}, {}},
          {{.edge = edge}, s.across, even, {}},
          {{.edge = edge}, NodeVector::r_mn, even, {}}};
}

std::unique_ptr<Joint> make_hold(std::string name, std::string body, std::vector<Held> held) {
  return std::make_unique<Hold>(std::move(name), std::move(body), std::move(held));
}

}  // namespace flexmorph::fem
