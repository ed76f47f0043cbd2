// The 18-bar cantilever of generalized geometry projection: the program's design from the published
// start, evaluated by the measure of the published program. Prints both values; the command is in
// tests/README.md.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <memory>
#include <sstream>

#include "geometry/parts/picture.h"
#include "tests/benchmark/compared_case.h"
#include "tests/benchmark/geometry_projection.h"
#include "tests/io/scratch.h"

namespace flexmorph::benchmark {
namespace {

constexpr double kVolume = 0.4;
/// Compliance of the best published run: 4 x 320 iterations, the radius of W from 2 to 1/2 (docs of
/// github.com/SimoneConiglio/generalized_geometry_projection, the authors' later program).
constexpr double kPublished = 73.52;

/// The cells have a quarter of the side of the measure's elements.
constexpr const char* kCase = R"(
title = "Short cantilever of generalized geometry projection"
[domain]
name = "plate"
size = [60.0, 30.0]
thickness = 1.0
youngs_modulus = 1.0
poisson_ratio = 0.3
[[support]]
edge = "left"
fix = ["x", "y"]
[[load]]
name = "tip"
[[load.force]]
point = [60.0, 15.0]
force = [0.0, -1.0]
[[design]]
cell = 0.25
components = [3, 3]
min_thickness = 0.5
band = [2.5, 1.5]
erosion_width = 0.0
min_feature = 0.0
[optimizer]
name = "mma"
max_iterations = 320
)";
/// The first run begins with the published start, disturbed (other seeds give up to 2 % more). The
/// second run continues from its result with more material: an element that is half filled by one
/// bar has 0.31 in the measure, in stiffness and density, therefore 0.4 in the measure is more by
/// area.
const std::vector<std::string> kFirst = {"design.jitter=0.1", "design.seed=1",
                                         "design.max_volume=0.4"};
const std::vector<std::string> kSecond = {"design.max_volume=0.425"};

/// Returns two crossed bars at nine locations, as long and thick as the published ones.
std::vector<Component> published_bars() {
  std::vector<Component> out;
  const double half = std::hypot(60 / 3., 30 / 3.) + 1, angle = std::atan2(30, 60);
  for (const double sign : {1., -1.})
    for (const double x : {0., 30., 60.})
      for (const double y : {0., 15., 30.}) out.push_back({{x, y}, half, sign * angle, 1, 1, 1});
  return out;
}

std::string csv(std::span<const Component> components) {
  std::ostringstream out;
  out.precision(17);
  out << "X0,Y0,half_length,angle,c1,c2,c3\n";
  for (const Component& c : components) {
    const auto values = c.parameters();
    for (std::size_t k = 0; k < values.size(); ++k)
      out << values[k] << (k + 1 < values.size() ? ',' : '\n');
  }
  return out.str();
}

/// Returns the case with a start layout.
std::unique_ptr<ComparedCase> case_from(const Scratch& scratch, std::span<const Component> start,
                                        std::vector<std::string> changes) {
  changes.push_back("design.start='" + scratch.write("bars.csv", csv(start)) + "'");
  return std::make_unique<ComparedCase>(scratch.write("cantilever.toml", kCase), changes);
}

/// How elements are computed from a design.
enum class Elements { each_component, their_union, area_fractions };

struct Measured {
  double compliance = 0, volume = 0, thicker = 0;
};

/// Returns all components thickened by `by` on each side [m].
std::vector<Component> thicker(std::vector<Component> components, double by) {
  for (Component& c : components)
    for (double* const half : {&c.c1, &c.c2, &c.c3}) *half += by;
  return components;
}

ProjectedElements elements_of(const Grid& grid, std::span<const Component> components,
                              double min_half_thickness, Elements how) {
  if (how == Elements::area_fractions) {
    const VectorXd part = area_fractions(grid, components, min_half_thickness, {}, {});
    return {part.cwiseMax(1e-6), part};
  }
  std::vector<ProjectedFeature> features;
  if (how == Elements::their_union)
    features = {feature_of(components, min_half_thickness, {{0, 0}, {grid.width, grid.height}})};
  else
    for (const Component& c : components) features.push_back(feature_of(c, min_half_thickness));
  return project(grid, features);
}

/// Returns the measure with the components as thick as the volume of the measure permits.
Measured measured(const std::vector<Component>& components, double min_half_thickness,
                  Elements how) {
  const Grid grid{0, 0, 60, 30, 60, 30};
  const auto at = [&](double by) {
    return elements_of(grid, thicker(components, by), min_half_thickness + by, how);
  };
  double low = -0.25, high = 0.25;
  for (int k = 0; k < 20; ++k) {
    const double middle = 0.5 * (low + high);
    (at(middle).volume() > kVolume ? high : low) = middle;
  }
  const ProjectedElements found = at(low);
  return {short_cantilever(grid, found.stiffness), found.volume(), low};
}

TEST(EighteenBars, InThePublishedMeasure) {
  const Scratch scratch;
  const auto first = case_from(scratch, published_bars(), kFirst);
  const ComparedDesign early = design_by_components(*first);
  const auto second = case_from(scratch, first->problem.design.components(), kSecond);
  const ComparedDesign own = design_by_components(*second);
  const std::vector<Component> components = second->problem.design.components();
  std::printf("body-fitted %.4g at volume %.4f, %zu components, CPU %.1f s\n",
              own.verdict.compliance, own.volume, components.size(), early.seconds + own.seconds);
  const double least = second->problem.bands.back().min_half_thickness;
  for (const auto& [name, how] : {std::pair{"each component", Elements::each_component},
                                  std::pair{"their union", Elements::their_union},
                                  std::pair{"area fractions", Elements::area_fractions}}) {
    const Measured found = measured(components, least, how);
    std::printf("%-15s C %.3f at volume %.4f (thicker by %.3f); published %.2f: ratio %.4f\n", name,
                found.compliance, found.volume, found.thicker, kPublished,
                found.compliance / kPublished);
    EXPECT_NEAR(found.volume, kVolume, 1e-3 * kVolume);
    EXPECT_TRUE(std::isfinite(found.compliance));
  }
}

}  // namespace
}  // namespace flexmorph::benchmark
