#include "optim/mmc/design.h"

#include <algorithm>
#include <numbers>

namespace flexmorph::mmc {

namespace {
constexpr int kN = Component::kParameters;
}

Design::Design(const Grid& domain, std::vector<Component> start, const DesignScale& scale)
    : domain_(domain), scale_(scale) {
  const auto n = static_cast<Eigen::Index>(start.size()) * kN;
  for (VectorXd* v : {&x_, &lower_, &upper_, &unit_}) v->resize(n);
  const double size = 2 * scale.half_length, pi = std::numbers::pi;
  for (size_t c = 0; c < start.size(); ++c) {
    const auto p = start[c].parameters();
    const double lower[kN] = {domain.x0,          domain.y0,           shortest(),
                              p[3] - 2 * pi,      scale.min_thickness, scale.min_thickness,
                              scale.min_thickness};
    const double upper[kN] = {domain.x0 + domain.width,
                              domain.y0 + domain.height,
                              std::max(8 * scale.half_length, 2 * scale.min_thickness),
                              p[3] + 2 * pi,
                              scale.max_thickness,
                              scale.max_thickness,
                              scale.max_thickness};
    const double unit[kN] = {size, size, size, pi, 0.5 * size, 0.5 * size, 0.5 * size};
    for (int k = 0; k < kN; ++k) {
      const auto i = static_cast<Eigen::Index>(c) * kN + k;
      unit_[i] = unit[k];
      lower_[i] = lower[k] / unit[k];
      upper_[i] = upper[k] / unit[k];
      x_[i] = std::clamp(p[static_cast<size_t>(k)] / unit[k], lower_[i], upper_[i]);
    }
  }
}

Design Design::with(std::vector<Component> components) const {
  Design out(domain_, components, scale_);
  for (size_t c = 0; c < components.size(); ++c) {
    const auto p = components[c].parameters();
    for (int k = 0; k < kN; ++k) {
      const auto i = static_cast<Eigen::Index>(c) * kN + k;
      out.x_[i] = p[static_cast<size_t>(k)] / out.unit_[i];
      out.lower_[i] = std::min(out.lower_[i], out.x_[i]);
      out.upper_[i] = std::max(out.upper_[i], out.x_[i]);
    }
  }
  return out;
}

double Design::shortest() const { return std::max(0.6 * scale_.half_length, scale_.min_thickness); }

void Design::components(const VectorXd& x, std::vector<Component>& out) const {
  out.resize(static_cast<size_t>(x.size() / kN));
  double p[kN];
  for (size_t c = 0; c < out.size(); ++c) {
    for (int k = 0; k < kN; ++k) {
      const auto i = static_cast<Eigen::Index>(c) * kN + k;
      p[k] = x[i] * unit_[i];
    }
    out[c] = Component::from_parameters(p);
  }
}

std::vector<Component> Design::components() const {
  std::vector<Component> out;
  components(x_, out);
  return out;
}

void Design::scale_gradient(VectorXd& g) const { g = g.cwiseProduct(unit_); }

void Design::scale_gradients(MatrixXd& rows) const { rows = rows * unit_.asDiagonal(); }

double Design::move_to(const VectorXd& x) {
  const double change = (x - x_).lpNorm<Eigen::Infinity>();
  x_ = x;
  return change;
}

}  // namespace flexmorph::mmc
