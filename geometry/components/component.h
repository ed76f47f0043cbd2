#pragma once

#include <array>
#include <vector>

#include "geometry/base.h"

namespace flexmorph {

/// One morphable component: a superellipse of order p = 6 around a straight axis.
///
///   1 - (x/L)^6 - (y/g(x))^6 = 0 on the outline,  (x, y) in the component's own frame
///
/// Source: P (24)-(27), where P is Sun et al. (2018), see the bibliography in fem/README.md.
///
/// The profile g is the parabola P (26). Well beyond the tips it is constant, and it has the
/// minimum half-thickness as a lower bound (see profile()). Bounds on c1, c2 and c3 alone do not
/// suffice, because the parabola may be lower than all three of them by up to a quarter.
struct Component {
  static constexpr int kParameters = 7;  ///< Number of parameters of a component.

  Vec2 center{0, 0};                  ///< Center (X0, Y0) of the component [m].
  double half_length = 1, angle = 0;  ///< Half-length L [m] and angle θ of the axis [rad].

  /// Half-thickness at x = -L (c1), x = +L (c2) and x = 0 (c3) [m].
  double c1 = 0.1, c2 = 0.1, c3 = 0.1;

  /// Returns the parameters X0, Y0, L, θ, c1, c2, c3 in the order of P (27).
  std::array<double, kParameters> parameters() const;
  /// Returns the component with seven parameters in the order of parameters().
  static Component from_parameters(const double* p);
};

/// Half-thickness g and its derivatives at one x of the component's frame. T is double or a number
/// type that carries derivatives (automatic differentiation).
template <class T>
struct BasicProfile {
  T g;                     ///< Half-thickness [m].
  T dg_dx;                 ///< Derivative of g by x [-]; 0 where x is clamped.
  std::array<T, 4> dg_dp;  ///< Derivatives of g by L (at fixed x), c1, c2 and c3 [-].
};
/// Half-thickness and its derivatives as plain numbers.
using Profile = BasicProfile<double>;

/// Returns the half-thickness g(x) of P (26) with a lower bound. It is twice continuously
/// differentiable in x and all parameters.
///
///   g < m - d:  m,    |g - m| < d:  m + 2 d (t³ - t⁴/2), t = (g - m + d)/(2 d),    else g itself
///
///   m  min_half_thickness > 0   [m]
///   d  half-width of the interval around m in which the bound is rounded: a tenth of m   [m]
///
/// Beyond the tips the parabola continues up to the value at 1.1 L, which it reaches at |x| = 1.2
/// L. From there on g is constant for every L.
Profile profile(const Component& c, double x, double min_half_thickness);

/// An axis-aligned box [m].
struct Box {
  Vec2 lower, upper;  ///< Lower left and upper right corner [m].
};

/// Returns an axis-aligned box that contains the whole outline. It is the bounding box of the
/// rotated rectangle [-L, L] x [-max g, max g], enlarged by `margin` on all sides [m]. The box uses
/// max g because the parabola may be larger than c1, c2 and c3.
Box bounding_box(const Component& c, double min_half_thickness, double margin);

/// Returns the closed outline as a counterclockwise polygon of `segments` vertices; no vertex is
/// repeated [m].
///
/// Every vertex lies on the exact outline (χ = 0). The vertices follow the polar angle of the unit
/// superellipse and are denser at its four corners. The area of the polygon converges with
/// segments^-2.
/// @throws Error (input) for fewer than 3 segments.
std::vector<Vec2> outline(const Component& c, double min_half_thickness, int segments);

/// Returns an initial layout of components: nx x ny boxes cover the domain, and each box holds two
/// components that cross along its diagonals. The first one has the angle +atan2(box height, box
/// width), the second one the negative angle. Boxes are numbered column by column, upwards in each
/// column.
/// @throws Error (input) when nx or ny is not positive.
std::vector<Component> crossing_layout(double x0, double y0, double width, double height, int nx,
                                       int ny, double half_thickness, double half_length);

}  // namespace flexmorph
