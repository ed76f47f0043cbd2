#pragma once

#include <numbers>
#include <vector>

#include "fem/dynamics/mesh_changes/moving_root.h"
#include "fem/elements/ancf_plate.h"

/// Small models for tests: meshes whose lines oscillate, smooth motions of all unknowns, and the
/// rotating, extending plate of P 4.2.
namespace flexmorph::testing {

using fem::AncfPlate;
using ShapeSet = fem::AncfPlate::ShapeSet;
using VectorRows = fem::VectorRows;

/// Returns n + 1 fixed lines with equal distances.
std::vector<fem::MaterialLine> uniform_lines(double from, double to, int n);

/// Returns a line at value + amplitude sin(angular frequency t), with its rate and acceleration.
fem::MaterialLine swinging_line(double value, double amplitude, double angular_frequency);

/// Returns a plate of 3 x 2 elements on unequally spaced lines. The root, one inner m-line and one
/// n-line oscillate with accelerations, each at its own frequency.
AncfPlate swinging_plate(ShapeSet shapes, double t = 0);

/// Returns random factors between 0.1 and 1 on cells whose boundaries do not coincide with the
/// lines of swinging_plate().
fem::ScaleFactors random_factors(unsigned seed);

/// Returns the integral of a scalar over element e by 7 x 7 points in each intersection with a cell
/// of the factors. No formula is shared with Element::tabulate(). f is called with one-point
/// tables.
double integrate(const AncfPlate& plate, int e, const fem::ScaleFactors& factors,
                 fem::ScaleFactorKind kind, fem::Tabulate what,
                 const std::function<double(const fem::ShapeTable&)>& f);

/// Returns unknowns that differ from the undeformed plate by random displacements of up to the
/// given fraction of the element size (slopes: up to the given number).
MatrixXd random_shape(const AncfPlate& plate, double size, unsigned seed);

/// A smooth motion of n numbers, q_i = mean_i + amplitude_i sin(angular_frequency_i t + phase_i).
class SmoothMotion {
 public:
  SmoothMotion(VectorXd mean, const VectorXd& scale, unsigned seed);
  VectorXd q(double t) const;
  VectorXd v(double t) const;
  VectorXd a(double t) const;
  fem::State state(double t) const;

 private:
  VectorXd wave(double t, int derivative) const;
  VectorXd mean_, amplitude_, angular_frequency_, phase_;
};

/// Returns the rows of one element out of all unknowns of a body (n_vectors x dim).
fem::LocalRows rows_of_element(const fem::Element& element, const MatrixXd& all, int e);

/// Plate that rotates with a hub at the origin and slides out of it, with a mass at its tip: P 4.2.
struct RotatingPlate {
  double length = 0.5, speed = 0.1, omega = 2 * std::numbers::pi, tip_mass = 0.5;
  double longest = 0;  ///< Length of the material [m]; 0: the length that 1 s of extension needs.
  int nx = 10, ny = 2;
  ShapeSet shapes = ShapeSet::h16;
  fem::WeldMode weld = fem::WeldMode::edge;
  fem::PlaneSection section{0.01, 1e8, 0.3, 2700};
  fem::ScaleFactors factors;
  VectorXd gravity;

  double width() const { return 0.1; }
  double whole() const { return longest > 0 ? longest : length + std::max(speed, 0.0); }
  Vec2 tip() const { return {whole(), 0}; }
};
struct Scene {
  fem::Workspace model;
  std::vector<fem::MovingRoot> moving_roots;
};
Scene make_scene(const RotatingPlate& plate);

/// Returns the position of a material point in the axes of the plate's hub.
Vec2 in_hub(const RotatingPlate& plate, const fem::Model& model, const fem::State& x,
            const Vec2& material);

/// Returns factors of 0.3 and 1 that alternate over patches of 6 x 6 cells of 2.5 mm.
fem::ScaleFactors chequered(const RotatingPlate& plate);

}  // namespace flexmorph::testing
