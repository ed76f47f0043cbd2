#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cases/assembly/build.h"
#include "cases/results/series.h"
#include "cases/scene/measure.h"

namespace flexmorph::cases {

/// The quantities of the [[measure]] tables of a scene, computed from states of its model.
class BodyMeasures {
 public:
  /// A measured body with its data that are constant during a motion.
  struct Measured {
    const MeasureRequest* measure = nullptr;  ///< The [[measure]] table of the body.
    size_t body = 0;                          ///< Index of the body in the model.
    std::array<Vec2, 3> material;  ///< Material points of the axis: root, middle, free end [m].
    std::array<Vec2, 3> start;     ///< Positions of root, middle and free end at the start [m].
    double sag = 0;                ///< Deflection of the middle of the axis at the start [m].

    /// Shape functions at the Gauss points, per element; empty if no quantity needs them.
    std::vector<fem::ShapeTable> tables;

    Vec2 arm{0, 0};  ///< Vector X - X_c from the centre of mass to the free end [m].
    double polar = 0;  ///< Polar second moment ∫ ρ |X - X_c|² dV about the centre of mass [kg m²].
  };

  /// Describes the values in the order of append().
  static std::vector<ColumnInfo> columns(const Scene& scene);

  /// Finds the measured bodies and computes their constant data.
  /// @param model  model built from the scene
  /// @param start  undeformed state; displacements are measured from it
  BodyMeasures(const Scene& scene, const fem::Model& model, const fem::State& start);

  /// Appends the values of a state to a row.
  /// @param heating  factor that multiplies the temperature rises, used by [static] analyses
  void append(const fem::Model& model, const fem::State& x, double heating,
              std::vector<double>& row) const;

 private:
  std::vector<Measured> bodies_;
};

}  // namespace flexmorph::cases
