#pragma once

#include <random>
#include <vector>

#include "geometry/components/component.h"

/// Random components for the tests of the geometry.
namespace flexmorph::test {

class RandomComponents {
 public:
  explicit RandomComponents(unsigned seed) : engine_(seed) {}

  double uniform(double lower, double upper) {
    return std::uniform_real_distribution<double>(lower, upper)(engine_);
  }

  /// Returns a component with its center inside width x height. The half-thicknesses are
  /// independent, so that profiles are convex, concave and tapered; sizes suit a domain of order 1.
  Component next(double width = 1, double height = 1) {
    Component c;
    c.center = {uniform(0, width), uniform(0, height)};
    c.half_length = uniform(0.1, 0.4);
    c.angle = uniform(-4, 4);
    c.c1 = uniform(0.02, 0.12);
    c.c2 = uniform(0.02, 0.12);
    c.c3 = uniform(0.02, 0.12);
    return c;
  }

  std::vector<Component> several(int count, double width, double height) {
    std::vector<Component> all;
    for (int k = 0; k < count; ++k) all.push_back(next(width, height));
    return all;
  }

 private:
  std::mt19937 engine_;
};

}  // namespace flexmorph::test
