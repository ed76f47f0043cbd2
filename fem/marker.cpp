#include "fem/marker.h"

#include <algorithm>
#include <cmath>

namespace flexmorph::fem {

void Marker::bind(std::span<const BodyView> bodies, const std::string& user, bool with_axis) {
  dofs_.clear();
  depends_.clear();
  if (!location_.point.allFinite() || !std::isfinite(location_.angle))
    throw Error::input(user + ": a number of its location is not finite");
  rigid_ = false;
  if (!location_.body.empty()) {
    const auto found = std::find_if(bodies.begin(), bodies.end(),
                                    [&](const BodyView& b) { return *b.name == location_.body; });
    if (found == bodies.end())
      throw Error::input(user + ": there is no body '" + location_.body + "'");
    const BodyView& body = *found;
    rigid_ = body.element->is_rigid();
    if (rigid_)
      bind_rigid(body.first_dof);
    else
      bind_plate(body, user, with_axis);
    if (!rigid_) return;
  }
  const auto n = static_cast<Eigen::Index>(dofs_.size());
  for (Block* block : {&block_, &block_rate_, &block_acceleration_}) block->setZero(4, n);
  offset_.setZero();
  offset_rate_.setZero();
  offset_acceleration_.setZero();
  const double c = std::cos(location_.angle), s = std::sin(location_.angle);
  if (rigid_) {
    block_.bottomRightCorner<2, 2>() << c, -s, s, c;
  } else {
    offset_.tail<2>() << c, s;
  }
  location_at(location_.point, 1, block_, offset_);
}

void Marker::bind_rigid(int first_dof) {
  dofs_ = {first_dof, first_dof + 1, first_dof + 2, first_dof + 3};
  const unsigned by_u = shifts() || !location_.point.isZero(0) ? 3U : 0U;
  depends_ = {1U, 2U, by_u | 12U, by_u | 12U};
}

void Marker::bind_plate(const BodyView& body, const std::string& user, bool with_axis) {
  const Element& element = *body.element;
  const auto refuse = [&](const std::string& why) {
    throw Error::input(user + ", body '" + location_.body + "': " + why);
  };
  if (element.dim() != 2) refuse("the location must be on a body in the plane");
  if (with_axis || location_.angle != 0) refuse("a location on a plate has no axes and no angle");
  if (location_.along) refuse("a location on a plate cannot move along an axis");
  ShapeTable table;
  const int e = element.locate(location_.point, Tabulate::position, table);
  if (element.moving(e)) refuse("the location cannot be in an element whose material lines move");
  const auto vectors = element.vectors(e);
  std::vector<std::pair<int, double>> weights;
  for (int k = 0; k < element.n_shapes(); ++k) {
    const int vector = vectors[static_cast<size_t>(k)];
    // At a node all other shape functions vanish up to round-off and need no entries.
    if (const double weight = table.N(0, k); std::abs(weight) > 1e-14 * element.scale(vector))
      weights.emplace_back(body.first_dof + 2 * vector, weight);
  }
  const auto n = static_cast<Eigen::Index>(2 * weights.size());
  for (Block* block : {&block_, &block_rate_, &block_acceleration_}) block->setZero(4, n);
  for (const auto& [dof, weight] : weights)
    for (int c = 0; c < 2; ++c) {
      block_(c, static_cast<Eigen::Index>(dofs_.size())) = weight;
      dofs_.push_back(dof + c);
      depends_.push_back(1U << c);
    }
  offset_.setZero();
  offset_rate_.setZero();
  offset_acceleration_.setZero();
}

/// Sets the coefficients of a point (X, Y) of the body (position = 1) or of a vector in it
/// (position = 0).
void Marker::location_at(const Vec2& point, double position, Block& block,
                         Eigen::Vector4d& offset) const {
  if (!rigid_) {
    offset.head<2>() = point;
    return;
  }
  block.topLeftCorner<2, 2>() = position * Eigen::Matrix2d::Identity();
  block.topRightCorner<2, 2>() << point.x(), -point.y(), point.y(), point.x();
}

MarkerMotion Marker::evaluate(double t, const VectorXd& q, const VectorXd& v) const {
  if (shifts()) {
    const Motion s = location_.along(t);
    const Vec2 axis(std::cos(location_.angle), std::sin(location_.angle));
    location_at(location_.point + s.value * axis, 1, block_, offset_);
    location_at(s.rate * axis, 0, block_rate_, offset_rate_);
    location_at(s.acceleration * axis, 0, block_acceleration_, offset_acceleration_);
  }
  MarkerMotion out{offset_, offset_rate_, offset_rate_, offset_acceleration_};
  for (size_t k = 0; k < dofs_.size(); ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    const double x = q[dofs_[k]], x_t = v[dofs_[k]];
    out.y += x * block_.col(column);
    out.rate += x_t * block_.col(column);
    if (!shifts()) continue;
    out.y_t += x * block_rate_.col(column);
    out.rate += x * block_rate_.col(column);
    out.convective += 2 * x_t * block_rate_.col(column) + x * block_acceleration_.col(column);
  }
  return out;
}

void MarkerPair::bind(std::span<const BodyView> bodies, const std::string& user, bool axis_a,
                      bool axis_b) {
  a_.bind(bodies, user, axis_a);
  b_.bind(bodies, user, axis_b);
  dofs_.assign(a_.dofs().begin(), a_.dofs().end());
  dofs_.insert(dofs_.end(), b_.dofs().begin(), b_.dofs().end());
  if (dofs_.empty()) throw Error::input(user + ": both locations are on the ground");
  if (a_.is_rigid() && b_.is_rigid() && a_.location().body == b_.location().body)
    throw Error::input(user + ": both locations are on the same rigid body '" + a_.location().body +
                       "'");
}

bool MarkerPair::depends(int i, size_t k) const {
  const size_t n = a_.dofs().size();
  if (k < n) return i < 4 && a_.depends(i, k);
  return i >= 4 && b_.depends(i - 4, k - n);
}

MarkerPair::Values MarkerPair::column(size_t k) const {
  const size_t n = a_.dofs().size();
  Values out = Values::Zero();
  if (k < n)
    out.head<4>() = a_.block().col(static_cast<Eigen::Index>(k));
  else
    out.tail<4>() = b_.block().col(static_cast<Eigen::Index>(k - n));
  return out;
}

MarkerPair::Values MarkerPair::column_rate(size_t k) const {
  const size_t n = a_.dofs().size();
  Values out = Values::Zero();
  if (k < n)
    out.head<4>() = a_.block_rate().col(static_cast<Eigen::Index>(k));
  else
    out.tail<4>() = b_.block_rate().col(static_cast<Eigen::Index>(k - n));
  return out;
}

void MarkerPair::evaluate(double t, const VectorXd& q, const VectorXd& v) const {
  const MarkerMotion a = a_.evaluate(t, q, v), b = b_.evaluate(t, q, v);
  for (int i = 0; i < 4; ++i) {
    y_[i] = a.y[i];
    y_t_[i] = a.y_t[i];
    rate_[i] = a.rate[i];
    convective_[i] = a.convective[i];
    y_[4 + i] = b.y[i];
    y_t_[4 + i] = b.y_t[i];
    rate_[4 + i] = b.rate[i];
    convective_[4 + i] = b.convective[i];
  }
}

}  // namespace flexmorph::fem
