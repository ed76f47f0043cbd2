#pragma once

#include <array>
#include <vector>

#include "geometry/base.h"

namespace flexmorph {

/// One morphable component, P (24)-(27): a superellipse of order p = 6 around a straight axis.
///
///   1 - (x/L)^6 - (y/g(x))^6 = 0 on the outline,  (x, y) in the component's own frame
///
/// center       X0, Y0             [m]
/// half_length  L                  [m]
/// angle        θ of the axis      [rad]
/// c1, c2, c3   half-thickness at x = -L, x = +L and x = 0   [m]
///
/// The profile g is the parabola P (26), constant well beyond the tips, bounded below by the
/// minimum half-thickness (see profile()): three bounds on c alone let the parabola undercut
/// between its supports by up to a quarter.
struct Component {
  static constexpr int kParameters = 7;

  Vec2 center{0, 0};
  double half_length = 1, angle = 0;
  double c1 = 0.1, c2 = 0.1, c3 = 0.1;

  /// X0, Y0, L, θ, c1, c2, c3: the order of P (27).
  std::array<double, kParameters> parameters() const;
  static Component from_parameters(const double* p);
};

/// Half-thickness g and its derivatives at one x of the component's frame. T is a number, or one
/// that carries derivatives.
template <class T>
struct BasicProfile {
  T g;                     ///< [m]
  T dg_dx;                 ///< [-], 0 where x is clamped
  std::array<T, 4> dg_dp;  ///< by L (at fixed x), c1, c2, c3   [-]
};
using Profile = BasicProfile<double>;

/// g(x) of P (26) with a lower bound, twice continuously differentiable in x and all parameters.
///
///   g < m - d:  m,    |g - m| < d:  m + 2 d (t³ - t⁴/2), t = (g - m + d)/(2 d),    else g itself
///
/// m  min_half_thickness > 0   [m]
/// d  0.1 m: how far around m the bound is rounded
///
/// Beyond the tips the parabola goes on to 1.1 L, reached at |x| = 1.2 L; from there on g is
/// constant, whatever L is.
Profile profile(const Component& c, double x, double min_half_thickness);

/// Axis-aligned box [m].
struct Box {
  Vec2 lower, upper;
};

/// Box that holds the outline for certain: the rotated rectangle [-L, L] x [-max g, max g] in an
/// axis-aligned one, grown by `margin` on all sides [m]. The parabola may bulge beyond every c.
Box bounding_box(const Component& c, double min_half_thickness, double margin);

/// Closed outline, counterclockwise, `segments` vertices, none repeated [m].
///
/// Every vertex lies on the exact outline (χ = 0). Vertices follow the polar angle of the unit
/// superellipse, drawn together in its four corners; the area converges with segments^-2.
/// @throws Error(input) for fewer than 3 segments.
std::vector<Vec2> outline(const Component& c, double min_half_thickness, int segments);

/// Initial layout: nx x ny boxes over the domain, two crossing components in each, along the
/// diagonals: angle +atan2(box height, box width), then the same with -. Boxes column by column,
/// upwards in each.
/// @throws Error(input) when nx or ny is not positive.
std::vector<Component> crossing_layout(double x0, double y0, double width, double height, int nx,
                                       int ny, double half_thickness, double half_length);

}  // namespace flexmorph
