#pragma once

#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "fem/bushing.h"
#include "fem/force_element.h"
#include "fem/stop.h"
#include "tests/support/differences.h"
#include "tests/support/models.h"
#include "tests/support/rigid_models.h"

/// Force elements of every kind between two rigid bodies, a plate and the ground.
namespace flexmorph::fem::test {

inline Motion shift(double t) {
  return {0.2 * std::sin(2.3 * t), 0.46 * std::cos(2.3 * t), -1.058 * std::sin(2.3 * t)};
}
inline MarkerLocation one() { return {.body = "one", .point = {0.3, -0.2}, .angle = 0.8}; }
inline MarkerLocation one_shifted() {
  return {.body = "one", .point = {0.3, -0.2}, .angle = 0.8, .along = shift};
}
inline MarkerLocation two() { return {.body = "two", .point = {-0.1, 0.4}, .angle = -1.9}; }
inline MarkerLocation ground() { return {.point = {2, 1}, .angle = 0.3}; }
inline MarkerLocation ground_shifted() { return {.point = {2, 1}, .angle = 0.3, .along = shift}; }
inline MarkerLocation plate() { return {.body = "plate", .point = {0.13, 0.02}}; }

inline LoadLaw driven(std::vector<LoadLaw::Component> components) { return components; }

struct ForceElementCase {
  std::string name;
  enum Kind {
    between,  // between bodies, with markers that do not move in their bodies
    outside   // from the ground, or with markers that move
  } kind;
  bool stores;  // true: conservative, so that all work is stored as energy
  std::function<std::unique_ptr<ForceElement>()> make;
};

inline std::vector<ForceElementCase> force_element_cases() {
  return {
      {"spring", ForceElementCase::between, true,
       [] {
         return make_spring("l", one(), two(), {3, 0, 0.4});
       }},
      {"spring_shifted", ForceElementCase::outside, true,
       [] {
         return make_spring("l", one_shifted(), two(), {3, 0, 0.4});
       }},
      {"spring_without_length", ForceElementCase::between, true,
       [] {
         return make_spring("l", two(), plate(), {3, 0, 0});
       }},
      {"damper", ForceElementCase::between, false,
       [] {
         return make_spring("l", one(), two(), {0, 2, 0});
       }},
      {"damped_spring", ForceElementCase::outside, false,
       [] {
         return make_spring("l", ground_shifted(), one_shifted(), {3, 2, 0.4});
       }},
      {"damped_spring_on_plate", ForceElementCase::outside, false,
       [] {
         return make_spring("l", plate(), one_shifted(), {3, 2, 0.4});
       }},
      {"torsion_spring", ForceElementCase::between, true,
       [] {
         return make_torsion_spring("l", one(), two(), {3, 0, 0.4});
       }},
      {"damped_torsion_spring", ForceElementCase::outside, false,
       [] {
         return make_torsion_spring("l", ground(), two(), {3, 2, -1});
       }},
      {"bushing", ForceElementCase::between, true,
       [] {
         return make_bushing("l", one(), two(), {{3, 0.7}, {0, 0}, 2, 0, 0.4, {}});
       }},
      {"bushing_shifted", ForceElementCase::outside, true,
       [] {
         return make_bushing("l", one_shifted(), two(), {{3, 0.7}, {0, 0}, 2, 0, 0.4, {}});
       }},
      {"damped_bushing", ForceElementCase::outside, false,
       [] {
         return make_bushing("l", ground_shifted(), two(), {{3, 0.7}, {2, 1}, 2, 0.6, 1, {}});
       }},
      {"damped_bushing_on_plate", ForceElementCase::outside, false,
       [] {
         return make_bushing("l", one(), plate(), {{3, 0.7}, {2, 1}, 0, 0, 0, {}});
       }},
      {"stop", ForceElementCase::between, true,
       [] {
         return make_stop(
             "l", one(), two(),
             {.coordinate = StopData::Coordinate::along, .most = -9, .stiffness = 0.1});
       }},
      {"damped_stop", ForceElementCase::outside, false,
       [] {
         return make_stop("l", one_shifted(), plate(),
                          {.coordinate = StopData::Coordinate::along,
                           .most = -9,
                           .stiffness = 9,
                           .damping = 0.2});
       }},
      {"stop_in_onset", ForceElementCase::between, true,
       [] {
         return make_stop(
             "l", one(), two(),
             {.coordinate = StopData::Coordinate::along, .most = -9, .stiffness = 2, .onset = 99});
       }},
      {"damped_stop_in_onset", ForceElementCase::outside, false,
       [] {
         return make_stop("l", one_shifted(), plate(),
                          {.coordinate = StopData::Coordinate::along,
                           .most = -9,
                           .stiffness = 9,
                           .damping = 0.2,
                           .onset = 99});
       }},
      {"least_stop", ForceElementCase::between, true,
       [] {
         return make_stop(
             "l", one(), two(),
             {.coordinate = StopData::Coordinate::along, .least = 9, .stiffness = 0.1});
       }},
      {"damped_least_stop", ForceElementCase::outside, false,
       [] {
         return make_stop("l", one_shifted(), plate(),
                          {.coordinate = StopData::Coordinate::along,
                           .least = 9,
                           .stiffness = 9,
                           .damping = 0.2});
       }},
      {"least_stop_in_onset", ForceElementCase::between, true,
       [] {
         return make_stop(
             "l", one(), two(),
             {.coordinate = StopData::Coordinate::along, .least = 9, .stiffness = 2, .onset = 99});
       }},
      {"damped_least_stop_in_onset", ForceElementCase::outside, false,
       [] {
         return make_stop("l", one_shifted(), plate(),
                          {.coordinate = StopData::Coordinate::along,
                           .least = 9,
                           .stiffness = 9,
                           .damping = 0.2,
                           .onset = 99});
       }},
      {"distance_stop", ForceElementCase::between, true,
       [] {
         return make_stop(
             "l", one(), two(),
             {.coordinate = StopData::Coordinate::distance, .most = 0.01, .stiffness = 3});
       }},
      {"damped_distance_stop", ForceElementCase::outside, false,
       [] {
         return make_stop("l", one_shifted(), plate(),
                          {.coordinate = StopData::Coordinate::distance,
                           .most = 0.01,
                           .stiffness = 9,
                           .damping = 0.2});
       }},
      {"distance_stop_in_onset", ForceElementCase::between, true,
       [] {
         return make_stop("l", one(), two(),
                          {.coordinate = StopData::Coordinate::distance,
                           .most = 0.01,
                           .stiffness = 60,
                           .onset = 99});
       }},
      {"damped_distance_stop_in_onset", ForceElementCase::outside, false,
       [] {
         return make_stop("l", one_shifted(), plate(),
                          {.coordinate = StopData::Coordinate::distance,
                           .most = 0.01,
                           .stiffness = 9,
                           .damping = 0.2,
                           .onset = 99});
       }},
      {"angle_stop", ForceElementCase::between, true,
       [] {
         return make_stop(
             "l", one(), two(),
             {.coordinate = StopData::Coordinate::angle, .most = -8, .stiffness = 0.1});
       }},
      {"damped_angle_stop", ForceElementCase::outside, false,
       [] {
         return make_stop("l", one_shifted(), two(),
                          {.coordinate = StopData::Coordinate::angle,
                           .most = -8,
                           .stiffness = 9,
                           .damping = 0.2});
       }},
      {"angle_stop_in_onset", ForceElementCase::between, true,
       [] {
         return make_stop(
             "l", one(), two(),
             {.coordinate = StopData::Coordinate::angle, .most = -8, .stiffness = 2, .onset = 99});
       }},
      {"damped_angle_stop_in_onset", ForceElementCase::outside, false,
       [] {
         return make_stop("l", one_shifted(), two(),
                          {.coordinate = StopData::Coordinate::angle,
                           .most = -8,
                           .stiffness = 9,
                           .damping = 0.2,
                           .onset = 99});
       }},
      {"point_force_shifted", ForceElementCase::outside, true,
       [] { return make_point_force("l", one_shifted(), Vec2(2, -3)); }},
      {"point_force_on_plate", ForceElementCase::outside, true,
       [] { return make_point_force("l", plate(), Vec2(2, -3)); }},
      {"point_force_driven", ForceElementCase::outside, false,
       [] {
         return make_point_force(
             "l", one_shifted(),
             driven({[](double t) { return 2 * t; }, [](double t) { return t * t; }}));
       }},
      {"turning_force", ForceElementCase::outside, false,
       [] { return make_point_force("l", one_shifted(), Vec2(2, -3), true); }},
      {"turning_force_driven", ForceElementCase::outside, false,
       [] {
         return make_point_force(
             "l", two(),
             driven({[](double t) { return std::cos(t); }, [](double t) { return 1 - t; }}), true);
       }},
      {"torque_driven", ForceElementCase::outside, false,
       [] { return make_torque("l", two(), driven({[](double t) { return 1.7 + t; }})); }},
      {"torque", ForceElementCase::outside, false, [] { return make_torque("l", two(), 1.7); }}};
}

inline Workspace bodies() {
  Workspace model;
  model.add_body(
      "plate",
      std::make_unique<AncfPlate>(2, testing::ShapeSet::h16, testing::uniform_lines(0, 0.3, 2),
                                  testing::uniform_lines(-0.05, 0.05, 1)),
      {}, {});
  for (const char* name : {"one", "two"})
    model.add_body(name, std::make_unique<RigidBody>(1), {}, {});
  return model;
}

/// Returns a motion of bodies that are far apart, so that all directions are defined and no angle
/// passes ±π.
inline testing::SmoothMotion away(const Model& model) {
  VectorXd mean = model.reference().q;
  mean.segment<4>(model.body("one").first_dof) << 1, 0.2, 0.9, 0.3;
  mean.segment<4>(model.body("two").first_dof) << -0.6, 1.1, 0.4, 0.8;
  return {mean, VectorXd::Ones(mean.size()), 8};
}

}  // namespace flexmorph::fem::test
