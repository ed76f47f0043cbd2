#pragma once

#include <numbers>
#include <vector>

#include "fem/dynamics/mesh_changes/growth.h"
#include "fem/elements/ancf_plate.h"

/// Small models for tests: meshes whose lines swing, smooth motions of all unknowns, and the
/// rotating, growing plate of P 4.2 set up by hand.
namespace flexmorph::testing {

using fem::AncfPlate;
using ShapeSet = fem::AncfPlate::ShapeSet;
using VectorRows = fem::VectorRows;

/// n + 1 fixed lines, evenly spaced.
std::vector<fem::MaterialLine> even_lines(double from, double to, int n);

/// A line at value + amplitude sin(pulsation t), with its rate and acceleration.
fem::MaterialLine swinging_line(double value, double amplitude, double pulsation);

/// 3 x 2 elements on uneven lines: the root, one inner m-line and one n-line swing with
/// accelerations, each at its own frequency.
AncfPlate swinging_plate(ShapeSet shapes, double t = 0);

/// Uneven factors between 0.1 and 1 on cells that no line of swinging_plate() meets in general.
fem::Factors random_factors(unsigned seed);

/// Integral of a scalar over element e, cell by cell of the factors, by 7 x 7 points in each piece:
/// no formula in common with Element::tabulate(). f is called with one-point tables.
double integrate(const AncfPlate& plate, int e, const fem::Factors& factors, fem::FactorKind kind,
                 fem::Tabulate what, const std::function<double(const fem::ShapeTable&)>& f);

/// All unknowns away from the undeformed plate by random displacements of the given part of the
/// element size (slopes: by that number).
MatrixXd random_shape(const AncfPlate& plate, double size, unsigned seed);

/// A smooth motion of n numbers, q_i = mean_i + amplitude_i sin(pulsation_i t + phase_i).
class SmoothMotion {
 public:
  SmoothMotion(VectorXd mean, const VectorXd& scale, unsigned seed);
  VectorXd q(double t) const;
  VectorXd v(double t) const;
  VectorXd a(double t) const;
  fem::State state(double t) const;

 private:
  VectorXd wave(double t, int derivative) const;
  VectorXd mean_, amplitude_, pulsation_, phase_;
};

/// Rows of one element out of all unknowns of a body (n_vectors x dim).
fem::LocalRows rows_of_element(const fem::Element& element, const MatrixXd& all, int e);

/// Plate that turns with a hub at the origin and grows out of it, with a mass on its tip: P 4.2.
struct RotatingPlate {
  double length = 0.5, speed = 0.1, omega = 2 * std::numbers::pi, tip_mass = 0.5;
  double longest = 0;  ///< length in the material; 0: what 1 s of growth needs
  int nx = 10, ny = 2;
  ShapeSet shapes = ShapeSet::h16;
  fem::WeldMode weld = fem::WeldMode::edge;
  fem::PlaneSection section{0.01, 1e8, 0.3, 2700};
  fem::Factors factors;
  VectorXd gravity;

  double width() const { return 0.1; }
  double whole() const { return longest > 0 ? longest : length + std::max(speed, 0.0); }
  Vec2 tip() const { return {whole(), 0}; }
};
struct Scene {
  fem::Workspace model;
  std::vector<fem::Growth> growths;
};
Scene make_scene(const RotatingPlate& plate);

/// Position of a material point in the axes of the plate's hub.
Vec2 in_hub(const RotatingPlate& plate, const fem::Model& model, const fem::State& x,
            const Vec2& material);

/// Chequered factors, 0.3 and 1 over patches of 6 x 6 cells of 2.5 mm.
fem::Factors chequered(const RotatingPlate& plate);

}  // namespace flexmorph::testing
