#pragma once

#include <cmath>
#include <memory>

#include "fem/model/workspace.h"
#include "tests/support/particle_pendulum.h"

/// Two uncoupled oscillators: there are no joints, and the motion is known in closed form.
namespace flexmorph::testing {

/// A unit mass on springs to the origin, one for each direction.
class Springs final : public fem::Term {
 public:
  explicit Springs(const Vec2& stiffness) : stiffness_(stiffness) {}
  std::unique_ptr<fem::Term> clone() const override { return std::make_unique<Springs>(*this); }
  void prepare(const fem::Element&, const fem::ScaleFactors&, bool) override {}
  void add_force(int, const fem::Local& x, fem::LocalRows& force) const override {
    for (int c = 0; c < 2; ++c) force(0, c) += x.a(0, c) + stiffness_[c] * x.q(0, c);
  }
  void add_tangent(int, const fem::Local&, const fem::Weights& w,
                   fem::LocalTangent& tangent) const override {
    for (int c = 0; c < 2; ++c) tangent(c, c) += w.a + w.q * stiffness_[c];
  }

 private:
  Vec2 stiffness_;
};

/// The motion q_i = A_i cos(ω_i t); the size of the model is 1 m.
struct Oscillators {
  Vec2 omega, amplitude{1, 1};

  fem::Workspace model() const {
    fem::Workspace out;
    std::vector<std::unique_ptr<fem::Term>> terms;
    terms.push_back(std::make_unique<Springs>(omega.cwiseAbs2()));
    out.add_body("mass", std::make_unique<Particle>(), {}, std::move(terms));
    return out;
  }
  fem::State at(double t) const {
    fem::State x;
    x.t = t;
    x.q.resize(2);
    x.v.resize(2);
    x.a.resize(2);
    for (int c = 0; c < 2; ++c) {
      x.q[c] = amplitude[c] * std::cos(omega[c] * t);
      x.v[c] = -amplitude[c] * omega[c] * std::sin(omega[c] * t);
      x.a[c] = -omega[c] * omega[c] * x.q[c];
    }
    x.lambda.resize(0);
    return x;
  }
};

}  // namespace flexmorph::testing
