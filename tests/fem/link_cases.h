#pragma once

#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "fem/bushing.h"
#include "fem/link.h"
#include "fem/stop.h"
#include "tests/support/differences.h"
#include "tests/support/models.h"
#include "tests/support/rigid_models.h"

/// Links of every kind between two rigid bodies, a plate and the ground.
namespace flexmorph::fem::test {

inline Motion shift(double t) {
  return {0.2 * std::sin(2.3 * t), 0.46 * std::cos(2.3 * t), -1.058 * std::sin(2.3 * t)};
}
inline MarkerPlace one() { return {.body = "one", .point = {0.3, -0.2}, .angle = 0.8}; }
inline MarkerPlace one_shifted() {
  return {.body = "one", .point = {0.3, -0.2}, .angle = 0.8, .along = shift};
}
inline MarkerPlace two() { return {.body = "two", .point = {-0.1, 0.4}, .angle = -1.9}; }
inline MarkerPlace ground() { return {.point = {2, 1}, .angle = 0.3}; }
inline MarkerPlace ground_shifted() { return {.point = {2, 1}, .angle = 0.3, .along = shift}; }
inline MarkerPlace plate() { return {.body = "plate", .point = {0.13, 0.02}}; }

inline LoadLaw driven(std::vector<LoadLaw::Component> components) { return components; }

struct LinkCase {
  std::string name;
  enum Kind {
    between,  // bodies, without shifted places
    outside   // from the ground, or with shifted places
  } kind;
  bool stores;  // all it takes, and gives it back
  std::function<std::unique_ptr<Link>()> make;
};

inline std::vector<LinkCase> link_cases() {
  return {
      {"spring", LinkCase::between, true,
       [] {
         return make_spring("l", one(), two(), {3, 0, 0.4});
       }},
      {"spring_shifted", LinkCase::outside, true,
       [] {
         return make_spring("l", one_shifted(), two(), {3, 0, 0.4});
       }},
      {"spring_without_length", LinkCase::between, true,
       [] {
         return make_spring("l", two(), plate(), {3, 0, 0});
       }},
      {"damper", LinkCase::between, false,
       [] {
         return make_spring("l", one(), two(), {0, 2, 0});
       }},
      {"damped_spring", LinkCase::outside, false,
       [] {
         return make_spring("l", ground_shifted(), one_shifted(), {3, 2, 0.4});
       }},
      {"damped_spring_on_plate", LinkCase::outside, false,
       [] {
         return make_spring("l", plate(), one_shifted(), {3, 2, 0.4});
       }},
      {"torsion_spring", LinkCase::between, true,
       [] {
         return make_torsion_spring("l", one(), two(), {3, 0, 0.4});
       }},
      {"damped_torsion_spring", LinkCase::outside, false,
       [] {
         return make_torsion_spring("l", ground(), two(), {3, 2, -1});
       }},
      {"bushing", LinkCase::between, true,
       [] {
         return make_bushing("l", one(), two(), {{3, 0.7}, {0, 0}, 2, 0, 0.4, {}});
       }},
      {"bushing_shifted", LinkCase::outside, true,
       [] {
         return make_bushing("l", one_shifted(), two(), {{3, 0.7}, {0, 0}, 2, 0, 0.4, {}});
       }},
      {"damped_bushing", LinkCase::outside, false,
       [] {
         return make_bushing("l", ground_shifted(), two(), {{3, 0.7}, {2, 1}, 2, 0.6, 1, {}});
       }},
      {"damped_bushing_on_plate", LinkCase::outside, false,
       [] {
         return make_bushing("l", one(), plate(), {{3, 0.7}, {2, 1}, 0, 0, 0, {}});
       }},
      {"stop", LinkCase::between, true,
       [] {
         return make_stop(
             "l", one(), two(),
             {.coordinate = StopData::Coordinate::along, .most = -9, .stiffness = 0.1});
       }},
      {"damped_stop", LinkCase::outside, false,
       [] {
         return make_stop("l", one_shifted(), plate(),
                          {.coordinate = StopData::Coordinate::along,
                           .most = -9,
                           .stiffness = 9,
                           .damping = 0.2});
       }},
      {"stop_in_onset", LinkCase::between, true,
       [] {
         return make_stop(
             "l", one(), two(),
             {.coordinate = StopData::Coordinate::along, .most = -9, .stiffness = 2, .onset = 99});
       }},
      {"damped_stop_in_onset", LinkCase::outside, false,
       [] {
         return make_stop("l", one_shifted(), plate(),
                          {.coordinate = StopData::Coordinate::along,
                           .most = -9,
                           .stiffness = 9,
                           .damping = 0.2,
                           .onset = 99});
       }},
      {"least_stop", LinkCase::between, true,
       [] {
         return make_stop(
             "l", one(), two(),
             {.coordinate = StopData::Coordinate::along, .least = 9, .stiffness = 0.1});
       }},
      {"damped_least_stop", LinkCase::outside, false,
       [] {
         return make_stop("l", one_shifted(), plate(),
                          {.coordinate = StopData::Coordinate::along,
                           .least = 9,
                           .stiffness = 9,
                           .damping = 0.2});
       }},
      {"least_stop_in_onset", LinkCase::between, true,
       [] {
         return make_stop(
             "l", one(), two(),
             {.coordinate = StopData::Coordinate::along, .least = 9, .stiffness = 2, .onset = 99});
       }},
      {"damped_least_stop_in_onset", LinkCase::outside, false,
       [] {
         return make_stop("l", one_shifted(), plate(),
                          {.coordinate = StopData::Coordinate::along,
                           .least = 9,
                           .stiffness = 9,
                           .damping = 0.2,
                           .onset = 99});
       }},
      {"distance_stop", LinkCase::between, true,
       [] {
         return make_stop(
             "l", one(), two(),
             {.coordinate = StopData::Coordinate::distance, .most = 0.01, .stiffness = 3});
       }},
      {"damped_distance_stop", LinkCase::outside, false,
       [] {
         return make_stop("l", one_shifted(), plate(),
                          {.coordinate = StopData::Coordinate::distance,
                           .most = 0.01,
                           .stiffness = 9,
                           .damping = 0.2});
       }},
      {"distance_stop_in_onset", LinkCase::between, true,
       [] {
         return make_stop("l", one(), two(),
                          {.coordinate = StopData::Coordinate::distance,
                           .most = 0.01,
                           .stiffness = 60,
                           .onset = 99});
       }},
      {"damped_distance_stop_in_onset", LinkCase::outside, false,
       [] {
         return make_stop("l", one_shifted(), plate(),
                          {.coordinate = StopData::Coordinate::distance,
                           .most = 0.01,
                           .stiffness = 9,
                           .damping = 0.2,
                           .onset = 99});
       }},
      {"angle_stop", LinkCase::between, true,
       [] {
         return make_stop(
             "l", one(), two(),
             {.coordinate = StopData::Coordinate::angle, .most = -8, .stiffness = 0.1});
       }},
      {"damped_angle_stop", LinkCase::outside, false,
       [] {
         return make_stop("l", one_shifted(), two(),
                          {.coordinate = StopData::Coordinate::angle,
                           .most = -8,
                           .stiffness = 9,
                           .damping = 0.2});
       }},
      {"angle_stop_in_onset", LinkCase::between, true,
       [] {
         return make_stop(
             "l", one(), two(),
             {.coordinate = StopData::Coordinate::angle, .most = -8, .stiffness = 2, .onset = 99});
       }},
      {"damped_angle_stop_in_onset", LinkCase::outside, false,
       [] {
         return make_stop("l", one_shifted(), two(),
                          {.coordinate = StopData::Coordinate::angle,
                           .most = -8,
                           .stiffness = 9,
                           .damping = 0.2,
                           .onset = 99});
       }},
      {"point_force_shifted", LinkCase::outside, true,
       [] { return make_point_force("l", one_shifted(), Vec2(2, -3)); }},
      {"point_force_on_plate", LinkCase::outside, true,
       [] { return make_point_force("l", plate(), Vec2(2, -3)); }},
      {"point_force_driven", LinkCase::outside, false,
       [] {
         return make_point_force(
             "l", one_shifted(),
             driven({[](double t) { return 2 * t; }, [](double t) { return t * t; }}));
       }},
      {"turning_force", LinkCase::outside, false,
       [] { return make_point_force("l", one_shifted(), Vec2(2, -3), true); }},
      {"turning_force_driven", LinkCase::outside, false,
       [] {
         return make_point_force(
             "l", two(),
             driven({[](double t) { return std::cos(t); }, [](double t) { return 1 - t; }}), true);
       }},
      {"torque_driven", LinkCase::outside, false,
       [] { return make_torque("l", two(), driven({[](double t) { return 1.7 + t; }})); }},
      {"torque", LinkCase::outside, false, [] { return make_torque("l", two(), 1.7); }}};
}

inline Workspace bodies() {
  Workspace model;
  model.add_body(
      "plate",
      std::make_unique<AncfPlate>(2, testing::ShapeSet::h16, testing::even_lines(0, 0.3, 2),
                                  testing::even_lines(-0.05, 0.05, 1)),
      {}, {});
  for (const char* name : {"one", "two"})
    model.add_body(name, std::make_unique<RigidBody>(1), {}, {});
  return model;
}

/// Bodies apart, so that no direction is lost and no angle wraps on the way.
inline testing::SmoothMotion away(const Model& model) {
  VectorXd mean = model.reference().q;
  mean.segment<4>(model.body("one").first_dof) << 1, 0.2, 0.9, 0.3;
  mean.segment<4>(model.body("two").first_dof) << -0.6, 1.1, 0.4, 0.8;
  return {mean, VectorXd::Ones(mean.size()), 8};
}

}  // namespace flexmorph::fem::test
