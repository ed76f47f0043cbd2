#include "fem/thermal/thermal_force.h"

#include <cmath>

#include "fem/thermal/thermal_displacement.h"

namespace flexmorph::fem {

ThermalForce::ThermalForce(std::string name, std::string body, Heat heat, double area_density)
    : name_(std::move(name)),
      body_(std::move(body)),
      heat_(std::move(heat)),
      area_density_(area_density) {
  if (!heat_.temperature) throw Error::input("'" + name_ + "': the temperature is missing");
  if (!(area_density > 0) || !std::isfinite(area_density))
    throw Error::input("'" + name_ + "': a thermal force needs a body with mass");
}

void ThermalForce::bind(std::span<const BodyView> bodies) {
  const BodyView& body = find_body(bodies, name_, body_);
  if (body.element->dim() != 2)
    throw Error::input("'" + name_ +
                       "': the thermal force is only available in the plane, but body '" + body_ +
                       "' is three-dimensional");
  element_ = body.element;
  first_dof_ = body.first_dof;
  try {
    const ThermalMatrices m =
        thermal_matrices(*element_, area_density_, body.factors ? *body.factors : ScaleFactors{});
    B_ = m.M * m.from_centre();
  } catch (const Error& error) {
    throw Error(error.kind(), "'" + name_ + "', body '" + body_ + "': " + error.what());
  }
}

Vec2 ThermalForce::fit(const VectorXd& q) const {
  // Positions are relative to the first one, because Σ B_k = 0 over them and no digits are lost far
  // from the origin.
  const double* r = q.data() + first_dof_;
  const double x0 = r[0], y0 = r[1];
  Vec2 out(0, 0);
  for (Eigen::Index k = 0; k < B_.rows(); ++k, r += 2) {
    const bool position = element_->is_position(static_cast<int>(k));
    const double x = r[0] - (position ? x0 : 0), y = r[1] - (position ? y0 : 0);
    out[0] += B_(k, 0) * x + B_(k, 1) * y;
    out[1] += B_(k, 0) * y - B_(k, 1) * x;
  }
  return out;
}

double ThermalForce::rotation(const VectorXd& q) const {
  const Vec2 cs = fit(q);
  return std::atan2(cs[1], cs[0]);
}

Vec2 ThermalForce::direction(double t, const VectorXd& q) const {
  const double acceleration = heat_.stretch(t).acceleration;
  if (acceleration == 0) return {0, 0};
  const Vec2 cs = fit(q);
  const double size = cs.norm();
  if (!(size > 0) || !std::isfinite(size))
    throw Error::numerical("'" + name_ + "': the rotation of body '" + body_ + "' is not defined");
  return acceleration / size * cs;
}

void ThermalForce::add_force(const State& x, VectorXd& out) const {
  const Vec2 d = direction(x.t, x.q);
  if (d.isZero(0)) return;
  double* f = out.data() + first_dof_;
  for (Eigen::Index k = 0; k < B_.rows(); ++k, f += 2) {
    f[0] -= d[0] * B_(k, 0) - d[1] * B_(k, 1);
    f[1] -= d[1] * B_(k, 0) + d[0] * B_(k, 1);
  }
}

void ThermalForce::add_mean_force(const State& mean, const VectorXd&, const VectorXd&,
                                  VectorXd& out) const {
  add_force(mean, out);
}

double ThermalForce::power(const State& x) const {
  const Vec2 d = direction(x.t, x.q);
  const double* v = x.v.data() + first_dof_;
  double out = 0;
  for (Eigen::Index k = 0; k < B_.rows(); ++k, v += 2)
    out += (d[0] * B_(k, 0) - d[1] * B_(k, 1)) * v[0] + (d[1] * B_(k, 0) + d[0] * B_(k, 1)) * v[1];
  return out;
}

}  // namespace flexmorph::fem
