#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cases/assembly/build.h"
#include "cases/results/series.h"
#include "cases/scene/measure.h"

namespace flexmorph::cases {

/// Computes the quantities of the [[measure]] tables of a scene.
class BodyMeasures {
 public:
  /// A measured body, with what does not change during a motion.
  struct Measured {
    const Measure* measure = nullptr;
    size_t body = 0;                      // of the model
    std::array<Vec2, 3> material;         // root, middle and free end of the axis
    std::array<Vec2, 3> start;            // their places
    double sag = 0;                       // deflection of the middle at the start
    std::vector<fem::ShapeTable> tables;  // Gauss points, where strains are asked for
    Vec2 arm{0, 0};                       // X - X_c of the free end
    double polar = 0;                     // ∫ ρ |X - X_c|² dV
  };

  /// Describes the values in the order of append().
  static std::vector<ColumnInfo> columns(const Scene& scene);

  /// @param model  built from the scene
  /// @param start  undeformed state; displacements are counted from it
  BodyMeasures(const Scene& scene, const fem::Model& model, const fem::State& start);

  /// Appends the values of a state to a row.
  /// @param heating  factor of the temperatures in a [static] analysis
  void append(const fem::Model& model, const fem::State& x, double heating,
              std::vector<double>& row) const;

 private:
  std::vector<Measured> bodies_;
};

}  // namespace flexmorph::cases
