#include "geometry/components/component.h"

#include <CGAL/Aff_transformation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <cassert>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "geometry/components/component_frame.h"

namespace flexmorph {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using BodyPoses = CGAL::Aff_transformation_2<Kernel>;

/// Returns the transformation from the component's frame to the plane: a rotation by θ, then a
/// translation by (X0, Y0).
BodyPoses body_poses(const Component& c) {
  const BodyPoses turn(CGAL::ROTATION, std::sin(c.angle), std::cos(c.angle));
  const BodyPoses move(CGAL::TRANSLATION, Kernel::Vector_2(c.center.x(), c.center.y()));
  return move * turn;
}

/// Returns the point of u⁶ + v⁶ = 1 at the parameter t in [0, 2π).
///
/// The polar angle t + sin(4t)/8 halves the spacing at the corners, where the curvature is largest,
/// and increases it by half on the flanks.
Vec2 unit_superellipse(double t) {
  const double angle = t + 0.125 * std::sin(4 * t);
  const double u = std::cos(angle), v = std::sin(angle);
  const double radius = 1 / std::sqrt(std::cbrt(u * u * u * u * u * u + v * v * v * v * v * v));
  return {radius * u, radius * v};
}

}  // namespace

std::array<double, Component::kParameters> Component::parameters() const {
  return {center.x(), center.y(), half_length, angle, c1, c2, c3};
}

Component Component::from_parameters(const double* p) {
  return {.center = {p[0], p[1]},
          .half_length = p[2],
          .angle = p[3],
          .c1 = p[4],
          .c2 = p[5],
          .c3 = p[6]};
}

Profile profile(const Component& c, double x, double min_half_thickness) {
  assert(c.half_length > 0 && min_half_thickness > 0);
  return ComponentFrame(c, min_half_thickness).profile(x);
}

Box bounding_box(const Component& c, double min_half_thickness, double margin) {
  assert(c.half_length > 0 && min_half_thickness > 0);
  const double L = c.half_length;
  const double g = ComponentFrame(c, min_half_thickness).largest_half_thickness();
  const BodyPoses location = body_poses(c);
  CGAL::Bbox_2 box;
  for (const auto& [x, y] : {std::pair{-L, -g}, {L, -g}, {L, g}, {-L, g}}) {
    box += location.transform(Kernel::Point_2(x, y)).bbox();
  }
  return {{box.xmin() - margin, box.ymin() - margin}, {box.xmax() + margin, box.ymax() + margin}};
}

std::vector<Vec2> outline(const Component& c, double min_half_thickness, int segments) {
  assert(c.half_length > 0 && min_half_thickness > 0);
  if (segments < 3) {
    throw Error::input("outline: " + std::to_string(segments) +
                       " segments are given; at least 3 are needed");
  }
  const ComponentFrame frame(c, min_half_thickness);
  const BodyPoses location = body_poses(c);
  std::vector<Vec2> vertices;
  vertices.reserve(static_cast<std::size_t>(segments));
  for (int k = 0; k < segments; ++k) {
    const Vec2 unit = unit_superellipse(2 * std::numbers::pi * k / segments);
    const double x = c.half_length * unit.x();
    const Kernel::Point_2 p =
        location.transform(Kernel::Point_2(x, frame.half_thickness(x) * unit.y()));
    vertices.emplace_back(p.x(), p.y());
  }
  return vertices;
}

std::vector<Component> crossing_layout(double x0, double y0, double width, double height, int nx,
                                       int ny, double half_thickness, double half_length) {
  if (nx < 1 || ny < 1) {
    throw Error::input("crossing_layout: " + std::to_string(nx) + " x " + std::to_string(ny) +
                       " boxes: both numbers must be positive");
  }
  const double box_width = width / nx, box_height = height / ny;
  const double diagonal = std::atan2(box_height, box_width);
  std::vector<Component> layout;
  layout.reserve(2 * static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny));
  for (int i = 0; i < nx; ++i) {
    for (int j = 0; j < ny; ++j) {
      for (const double angle : {diagonal, -diagonal}) {
        layout.push_back({.center = {x0 + (i + 0.5) * box_width, y0 + (j + 0.5) * box_height},
                          .half_length = half_length,
                          .angle = angle,
                          .c1 = half_thickness,
                          .c2 = half_thickness,
                          .c3 = half_thickness});
      }
    }
  }
  return layout;
}

}  // namespace flexmorph
