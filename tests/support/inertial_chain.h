#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "tests/support/reissner_beam.h"

namespace flexmorph::reference {

/// The rotating, extending plate as a chain of small shear-deformable elements in the inertial
/// frame. Lumped masses obey m r'' = f. Material inside the hub moves with the hub, and a node
/// becomes free when it leaves the hub (with values interpolated in the root element). Time
/// integration is by central differences. The model has no terms of a rotating frame or of material
/// flow.
class Chain {
 public:
  Chain(const ReissnerBeam& beam, int elements, double end) : b_(beam), h_(beam.length / elements) {
    for (int i = 1; i <= elements; ++i)
      node_.push_back({i * h_, {i * h_, 0, 0}, {b_.speed, b_.omega * i * h_, b_.omega}});
    dt_ = end / std::ceil(end / (0.25 * h_ * std::sqrt(b_.density / b_.youngs_modulus)));
  }
  double dt() const { return dt_; }
  double time() const { return t_; }

  void step() {
    accelerate(dt_ / 2);
    for (Node& node : node_) node.r += dt_ * node.v;
    t_ += dt_;
    release();
    accelerate(dt_ / 2);
  }

  Vec2 tip() const { return Eigen::Rotation2Dd(-b_.omega * t_) * Vec2(node_.back().r.head<2>()); }

 private:
  struct Node {
    double material;
    Vec3 r, v, f = Vec3::Zero();  // x, y, absolute angle
  };

  Vec3 hub() const { return {0, 0, b_.omega * t_}; }

  void release() {
    const double s = next_ + b_.speed * t_;
    if (s < 0.5 * h_) return;
    const double part = s / (node_.front().material + b_.speed * t_);
    const Vec3 inlet(b_.speed * std::cos(b_.omega * t_), b_.speed * std::sin(b_.omega * t_),
                     b_.omega);
    const Node& first = node_.front();
    node_.insert(node_.begin(),
                 {next_, hub() + part * (first.r - hub()), inlet + part * (first.v - inlet)});
    next_ -= h_;
  }

  void accelerate(double dt) {
    for (Node& node : node_) node.f.setZero();
    Vec3 discarded = Vec3::Zero();
    double length = node_.front().material + b_.speed * t_;
    element(length, hub(), node_.front().r, discarded, node_.front().f);
    for (size_t i = 0; i + 1 < node_.size(); ++i)
      element(h_, node_[i].r, node_[i + 1].r, node_[i].f, node_[i + 1].f);
    for (size_t i = 0; i < node_.size(); ++i) {
      const double share = (length + (i + 1 < node_.size() ? h_ : 0)) / 2;
      const double mass = share * b_.line_density() + (i + 1 < node_.size() ? 0 : b_.tip_mass);
      node_[i].v += dt * node_[i].f.cwiseQuotient(Vec3(mass, mass, share * b_.rotary_inertia()));
      length = h_;
    }
  }

  void element(double h, const Vec3& r1, const Vec3& r2, Vec3& f1, Vec3& f2) const {
    const double angle = (r1.z() + r2.z()) / 2, c = std::cos(angle), s = std::sin(angle);
    const Vec3 d = (r2 - r1) / h;
    const double stretch = c * d.x() + s * d.y(), slide = -s * d.x() + c * d.y();
    const double n = b_.axial_stiffness() * (stretch - 1), q = b_.shear_stiffness() * slide;
    const Vec3 force(c * n - s * q, s * n + c * q, b_.bending_stiffness() * d.z());
    const Vec3 couple(0, 0, h / 2 * (q * stretch - n * slide));
    f1 += force + couple;
    f2 += couple - force;
  }

  ReissnerBeam b_;
  // next_: the node inside the hub that is nearest to its opening
  double h_, next_ = 0, dt_ = 0, t_ = 0;
  std::vector<Node> node_;
};

}  // namespace flexmorph::reference
