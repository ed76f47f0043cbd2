#include <algorithm>
#include <functional>
#include <utility>

#include "cases/output/plots/plots.h"
#include "fem/triangles/t6.h"
#include "io/files.h"
#include "io/part_picture.h"

namespace flexmorph::cases {

namespace {

/// Fraction of the area whose stress may exceed the top of the colour scale; stress peaks at
/// corners would otherwise leave the rest of the picture dark.
constexpr double kPeaks = 0.005;

/// Returns the stress that is exceeded on the fraction kPeaks of the area.
double all_but_peaks(const verification::OutlineVerification& j, const std::vector<double>& mises) {
  std::vector<std::pair<double, double>> parts;  // stress and area of every triangle
  double area = 0;
  for (std::size_t t = 0; t < j.mesh.triangles.size(); ++t) {
    double mean = 0;
    for (const int node : j.mesh.triangles[t]) mean += mises[static_cast<std::size_t>(node)] / 6;
    parts.emplace_back(mean, fem::T6(j.mesh.corners(t)).area());
    area += parts.back().second;
  }
  std::sort(parts.begin(), parts.end(), std::greater<>());
  double above = 0;
  for (const auto& [stress, own] : parts) {
    above += own;
    if (above > kPeaks * area) return stress;
  }
  return 0;
}

std::string displacement_text(double magnification) {
  return magnification == 1 ? "true displacements"
                            : "displacements times " + io::to_text(magnification, 3);
}

/// Returns the name of a load in a sentence: "load 99" for the loads of a motion, else "load
/// 'tip'".
std::string shown_load(const std::string& name) {
  const std::string mark = "load_";
  return name.starts_with(mark) ? "load " + name.substr(mark.size()) : "load '" + name + "'";
}

}  // namespace

std::string stress_plot(const VerifiedOutline& outline) {
  if (!outline.verification || outline.verification->displacement.size() == 0) return "";
  const verification::OutlineVerification& j = *outline.verification;
  const std::vector<double> mises = mises_of(j);
  io::PartPicture picture;
  picture.upper = all_but_peaks(j, mises);
  if (!(picture.upper > 0)) return "";
  picture.values = mises;
  picture.displacement = {j.displacement.data(), static_cast<std::size_t>(j.displacement.size())};
  picture.magnification = io::clear_magnification(j.mesh, picture.displacement);
  picture.unit = "Pa";
  picture.left_out = j.omitted_triangles;
  picture.marked = j.shown_stress.at;
  picture.mark = "largest stress away from loads and supports";
  picture.title = "von Mises stress under " + shown_load(j.shown_load) + ", at most " +
                  io::to_text(j.shown_stress.value, 3) + " Pa away from loads and supports; " +
                  displacement_text(picture.magnification);
  return io::part_svg(j.mesh, picture);
}

}  // namespace flexmorph::cases
