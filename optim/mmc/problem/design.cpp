#include "optim/mmc/problem/design.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

namespace flexmorph::mmc {

namespace {

constexpr int kN = Component::kParameters;
/// Relative tolerance for the comparison of components with mirror images, in half-lengths [-].
constexpr double kSamePosition = 1e-9;

/// The map of component parameters to those of a mirror image: parameter' = sign * parameter +
/// shift.
struct Image {
  std::array<double, kN> sign{1, 1, 1, 1, 1, 1, 1}, shift{};

  static Image in(const std::optional<double>& x, const std::optional<double>& y) {
    Image out;
    if (x) {
      out.sign[0] *= -1;
      out.shift[0] = 2 * *x;
      out.sign[3] *= -1;
      out.shift[3] = std::numbers::pi;
    }
    if (y) {
      out.sign[1] *= -1;
      out.shift[1] = 2 * *y;
      out.sign[3] *= -1;
      out.shift[3] *= -1;
    }
    return out;
  }
  Component of(const Component& c) const {
    std::array<double, kN> p = c.parameters();
    for (size_t k = 0; k < kN; ++k) p[k] = sign[k] * p[k] + shift[k];
    return Component::from_parameters(p.data());
  }
};

/// Returns the maps to all mirror images; the first one is the identity.
std::vector<Image> images_of(const Symmetry& s) {
  std::vector<Image> out = {Image()};
  if (s.x) out.push_back(Image::in(s.x, {}));
  if (s.y) out.push_back(Image::in({}, s.y));
  if (s.x && s.y) out.push_back(Image::in(s.x, s.y));
  return out;
}

/// Returns true if two components cover equal areas, also when their ends are exchanged.
bool same(const Component& a, const Component& b) {
  const double small = kSamePosition * a.half_length;
  if ((a.center - b.center).norm() > small || std::abs(a.half_length - b.half_length) > small)
    return false;
  const bool along = std::abs(std::sin(a.angle - b.angle)) < kSamePosition;
  const bool turned = std::cos(a.angle - b.angle) < 0;
  return along && std::abs(a.c1 - (turned ? b.c2 : b.c1)) < small &&
         std::abs(a.c2 - (turned ? b.c1 : b.c2)) < small && std::abs(a.c3 - b.c3) < small;
}

/// Returns true if a component lies on the lower (left) side of the symmetry lines or on them.
bool on_own_side(const Component& c, const Symmetry& symmetry) {
  const double small = kSamePosition * c.half_length;
  return !(symmetry.x && c.center.x() > *symmetry.x + small) &&
         !(symmetry.y && c.center.y() > *symmetry.y + small);
}

/// A set of components that is sorted by location, so that a search compares only few of them.
class ByLocation {
 public:
  void add(const Component& c) { all_.emplace(key(c), c); }
  bool has(const Component& wanted) const {
    const double reach = 2 * kSamePosition * wanted.half_length;
    const auto end = all_.upper_bound(key(wanted) + reach);
    return std::any_of(all_.lower_bound(key(wanted) - reach), end,
                       [&](const auto& known) { return same(wanted, known.second); });
  }

 private:
  /// Returns the coordinate along a direction that is not perpendicular to rows or columns of
  /// layouts, so that components of one row or column have different keys.
  static double key(const Component& c) {
    constexpr double kSlope = 0.6180339887;
    return c.center.x() + kSlope * c.center.y();
  }

  std::multimap<double, Component> all_;
};

}  // namespace

std::string to_string(const Symmetry& symmetry) {
  if (symmetry.x && symmetry.y) return "both";
  return symmetry.x ? "x" : symmetry.y ? "y" : "none";
}

std::vector<Component> one_side(const std::vector<Component>& all, const Symmetry& symmetry) {
  if (!symmetry.any()) return all;
  const std::vector<Image> images = images_of(symmetry);
  std::vector<Component> out;
  ByLocation known;
  for (const Component& c : all) {
    const auto image = std::find_if(images.begin(), images.end(),
                                    [&](const Image& i) { return on_own_side(i.of(c), symmetry); });
    const Component own = image != images.end() ? image->of(c) : c;
    if (known.has(own)) continue;
    out.push_back(own);
    for (const Image& i : images) known.add(i.of(own));
  }
  return out;
}

bool is_symmetric(const std::vector<Component>& all, const Symmetry& symmetry) {
  const std::vector<Image> images = images_of(symmetry);
  ByLocation known;
  for (const Component& c : all) known.add(c);
  return std::all_of(images.begin() + 1, images.end(), [&](const Image& image) {
    return std::all_of(all.begin(), all.end(),
                       [&](const Component& c) { return known.has(image.of(c)); });
  });
}

Design::Design(const Grid& domain, const std::vector<Component>& start, const DesignScale& scale,
               const Symmetry& symmetry)
    : domain_(domain), scale_(scale), symmetry_(symmetry) {
  const std::vector<Component> own = one_side(start, symmetry);
  const auto n = static_cast<Eigen::Index>(own.size()) * kN;
  VectorXd unit(n);
  for (VectorXd* v : {&x_, &lower_, &upper_}) v->resize(n);
  const double size = 2 * scale.half_length, pi = std::numbers::pi;
  for (size_t c = 0; c < own.size(); ++c) {
    const auto p = own[c].parameters();
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
    const double units[kN] = {size, size, size, pi, 0.5 * size, 0.5 * size, 0.5 * size};
    for (int k = 0; k < kN; ++k) {
      const auto i = static_cast<Eigen::Index>(c) * kN + k;
      unit[i] = units[k];
      lower_[i] = lower[k] / unit[i];
      upper_[i] = upper[k] / unit[i];
      x_[i] = std::clamp(p[static_cast<size_t>(k)] / unit[i], lower_[i], upper_[i]);
    }
  }
  add_images(n, unit);
}

/// Sets up the linear map from the design vector to the parameters of all components.
/// @param n     number of design variables
/// @param unit  component parameter per unit of x (n)
void Design::add_images(Eigen::Index n, const VectorXd& unit) {
  const std::vector<Image> images = images_of(symmetry_);
  const auto rows = n * static_cast<Eigen::Index>(images.size());
  std::vector<Eigen::Triplet<double>> entries;
  offset_.resize(rows);
  for (Eigen::Index row = 0; row < rows; ++row) {
    const Image& image = images[static_cast<size_t>(row / n)];
    const auto k = static_cast<size_t>(row % kN);
    entries.emplace_back(row, row % n, image.sign[k] * unit[row % n]);
    offset_[row] = image.shift[k];
  }
  to_parameters_.resize(rows, n);
  to_parameters_.setFromTriplets(entries.begin(), entries.end());
}

Design Design::with(const std::vector<Component>& components) const {
  Design out(domain_, components, scale_, symmetry_);
  const std::vector<Component> own = one_side(components, symmetry_);
  for (size_t c = 0; c < own.size(); ++c) {
    const auto p = own[c].parameters();
    for (int k = 0; k < kN; ++k) {
      const auto i = static_cast<Eigen::Index>(c) * kN + k;
      out.x_[i] = p[static_cast<size_t>(k)] / out.to_parameters_.coeff(i, i);
      out.lower_[i] = std::min(out.lower_[i], out.x_[i]);
      out.upper_[i] = std::max(out.upper_[i], out.x_[i]);
    }
  }
  return out;
}

double Design::shortest() const { return std::max(0.6 * scale_.half_length, scale_.min_thickness); }

void Design::components(const VectorXd& x, std::vector<Component>& out) const {
  const VectorXd p = to_parameters_ * x + offset_;
  out.resize(static_cast<size_t>(p.size() / kN));
  for (size_t c = 0; c < out.size(); ++c) out[c] = Component::from_parameters(p.data() + c * kN);
}

std::vector<Component> Design::components() const {
  std::vector<Component> out;
  components(x_, out);
  return out;
}

void Design::scale_gradient(VectorXd& g) const { g = VectorXd(to_parameters_.transpose() * g); }

void Design::scale_gradients(MatrixXd& rows) const { rows = MatrixXd(rows * to_parameters_); }

double Design::move_to(const VectorXd& x) {
  const double change = (x - x_).lpNorm<Eigen::Infinity>();
  x_ = x;
  return change;
}

}  // namespace flexmorph::mmc
