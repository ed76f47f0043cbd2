#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cases/run_folder.h"

namespace flexmorph::cases {

/// Quantities that a [[measure]] may list, and their columns <body>.<column>:
///
/// temperature          temperature [K]: ΔT of a hot body
/// max_elastic_strain   max_elastic_strain [-]: largest entry of the elastic Green strain
///                      (FᵀF/s² - 1)/2, s = 1 + α ΔT, over Gauss points (of a plate: mid-surface)
/// midpoint_deflection  midpoint_deflection [m]: of the middle of the axis across the line between
///                      its ends, less that of the undeformed body; positive to the left of the
///                      line from root to free end
/// end_displacements    root_ux, root_uy, end_ux, end_uy [m]: of the ends of the axis
/// end_velocity         end_vx, end_vy [m/s]: of the free end
/// end_slopes           end_rx, end_ry [-]: |∂r/∂X|, |∂r/∂Y| at the free end
/// free_expansion       free_ux, free_uy [m], free_kinetic [J]: of the same body, free, unstressed
///                      and not turned: displacement α ΔT (X - X_c) of the free end against its
///                      centre of mass, and kinetic energy (α Ṫ)² ½ ∫ ρ |X - X_c|² dV; T (12), (19)
const std::vector<std::string>& measured_quantities();

/// Names of the columns of a [[measure]].
std::vector<std::string> measured_columns(const Measure& measure);

/// Why a quantity cannot be measured; empty where it can.
std::string refusal_of_measure(const Scene& scene, const Body& body, const std::string& quantity);

/// What the [[measure]]s of a scene are, step by step.
class BodyMeasures {
 public:
  /// @param model  built from the scene
  /// @param start  undeformed, where displacements are counted from
  BodyMeasures(const Scene& scene, const fem::Model& model, const fem::State& start);

  /// The next row. @param heating  what the temperatures of a [static] analysis are multiplied by
  void add(const fem::Model& model, const fem::State& x, double heating = 1);
  const std::vector<Column>& columns() const { return columns_; }
  std::vector<Column> take() { return std::move(columns_); }

 private:
  /// One measured body, with what does not change.
  struct Measured {
    const Measure* measure = nullptr;
    size_t body = 0;               // of the model
    std::array<Vec2, 3> material;  // root, middle and free end of the axis
    std::array<Vec2, 3> start;     // their places
    double sag = 0;                // deflection of the middle at the start
    std::vector<fem::ShapeTable>
        tables;        // Gauss points of the elements, where strains are asked for
    Vec2 arm{0, 0};    // X - X_c of the free end
    double polar = 0;  // ∫ ρ |X - X_c|² dV
  };

  void put(double value) { columns_[next_++].values.push_back(value + 0.0); }  // no "-0"
  void put_quantity(const Measured& m, const std::string& quantity, const fem::Body& body,
                    const fem::State& x, double heating);

  std::vector<Measured> bodies_;
  std::vector<Column> columns_;
  size_t next_ = 0;
};

}  // namespace flexmorph::cases
