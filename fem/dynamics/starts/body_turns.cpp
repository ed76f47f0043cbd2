#include "fem/dynamics/starts/body_turns.h"

#include <cmath>

namespace flexmorph::fem {

namespace {

/// Rotation below which a kept tangent is not updated: it changes the contraction by a thousandth
/// [rad].
constexpr double kNoticed = 1e-4;

/// Returns the angle of the best rotation from the undeformed body to the positions q [rad].
double angle_of(const Body& body, const VectorXd& q) {
  const Element& element = *body.element;
  if (element.dim() != 2) return 0;
  const MatrixXd reference = element.reference();
  const int n = element.n_vectors();
  Vec2 mean = Vec2::Zero(), mean_now = Vec2::Zero();
  int positions = 0;
  for (int k = 0; k < n; ++k)
    if (element.is_position(k)) {
      mean += reference.row(k).transpose();
      mean_now += q.segment<2>(body.first_dof + 2 * k);
      ++positions;
    }
  if (positions > 0) {
    mean /= positions;
    mean_now /= positions;
  }
  double sine = 0, cosine = 0;
  for (int k = 0; k < n; ++k) {
    Vec2 x = reference.row(k), y = q.segment<2>(body.first_dof + 2 * k);
    if (element.is_position(k)) {
      x -= mean;
      y -= mean_now;
    }
    sine += x.x() * y.y() - x.y() * y.x();
    cosine += x.dot(y);
  }
  return std::atan2(sine, cosine);
}

std::vector<double> angles_of(const Model& model, const VectorXd& q) {
  std::vector<double> out;
  for (const Body& b : model.bodies()) out.push_back(angle_of(b, q));
  return out;
}

}  // namespace

void BodyTurns::begin(const Model& model, const VectorXd& q) {
  start_ = now_ = angles_of(model, q);
}

bool BodyTurns::follow(const Model& model, const VectorXd& q) {
  const std::vector<double> angles = angles_of(model, q);
  bool noticed = false;
  for (size_t k = 0; k < angles.size(); ++k)
    noticed |= std::abs(std::remainder(angles[k] - now_[k], 2 * M_PI)) > kNoticed;
  if (noticed) now_ = angles;
  return noticed;
}

std::vector<TurnedVectors> BodyTurns::turns(const Model& model) const {
  std::vector<TurnedVectors> out;
  for (size_t k = 0; k < now_.size(); ++k) {
    const Body& b = model.bodies()[k];
    const double angle = now_[k] - start_[k];
    if (b.element->dim() == 2)
      out.push_back({b.first_dof, b.first_dof + 2 * b.element->n_vectors(), std::cos(angle),
                     std::sin(angle)});
  }
  return out;
}

void BodyTurns::archive(Archive& memory) { memory(start_, now_); }

}  // namespace flexmorph::fem
