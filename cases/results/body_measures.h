#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cases/output/run_folder.h"
#include "cases/scene/measure.h"

namespace flexmorph::cases {

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
  void remember(Memory& memory) { memory(columns_); }

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
