#include "cases/results/motion_record.h"

#include <algorithm>
#include <cmath>

namespace flexmorph {

namespace io {

void archive(Archive& memory, PlanePlate& p) { memory(p.n_across, p.points, p.density); }
void archive(Archive& memory, PlaneFrame& f) { memory(f.title, f.plates, f.outlines); }

}  // namespace io

namespace cases {

double MotionRecord::strain_integral() const {
  const std::vector<double>* designed = table.find(kDesignedColumn);
  const std::vector<double>&t = time(), &strain = designed ? *designed : table.at(kStrainColumn);
  double out = 0;
  for (std::size_t i = 1; i < t.size(); ++i)
    out += 0.5 * (t[i] - t[i - 1]) * (strain[i - 1] + strain[i]);
  return out;
}

std::optional<double> MotionRecord::amplitude(const std::string& body) const {
  const std::vector<double>* deflection = table.find(body + kDeflectionEnding);
  if (!deflection) return {};
  return largest_size(*deflection);
}

Variation variation_of(std::span<const double> time, std::span<const double> values) {
  const auto mean_of = [&](const auto& f) {
    double sum = 0;
    for (std::size_t i = 1; i < time.size(); ++i)
      sum += 0.5 * (time[i] - time[i - 1]) * (f(values[i - 1]) + f(values[i]));
    return sum / (time.back() - time.front());
  };
  Variation out;
  out.mean = mean_of([](double v) { return v; });
  out.rms = std::sqrt(mean_of([&](double v) { return (v - out.mean) * (v - out.mean); }));
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  out.peak_to_peak = *most - *least;
  out.largest = largest_size(values);
  return out;
}

LargestError largest_error(const MotionRecord& motion, const std::string& body,
                           const std::string& quantity) {
  LargestError out;
  const std::vector<double>* values = motion.table.find(body + "." + quantity);
  for (std::size_t i = 0; values && i < values->size(); ++i)
    if (std::abs((*values)[i]) > out.size) out = {std::abs((*values)[i]), motion.time()[i]};
  return out;
}

}  // namespace cases

}  // namespace flexmorph
