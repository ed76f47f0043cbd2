#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "fem/dofs.h"
#include "fem/element.h"
#include "fem/heat.h"
#include "fem/joint.h"
#include "fem/link.h"
#include "fem/section.h"
#include "fem/term.h"

namespace flexmorph::fem {

/// One body: its elements, what it is made of, and the physical effects it takes part in.
struct Body {
  std::string name;
  std::unique_ptr<Element> element;
  PlaneSection section;
  std::vector<std::unique_ptr<Term>> terms;
  Factors factors;
  std::optional<Heat> heat{};  ///< absent: cold
  int first_dof = 0;

  /// Vector unknowns, entry by entry, then scalar ones.
  int n_dofs() const { return element->dim() * element->n_vectors() + element->n_scalars(); }
  int first_scalar() const { return first_dof + element->dim() * element->n_vectors(); }
};

/// Force [N] and moment about a point [N m]; in the plane only the z entry of the moment and no z
/// entry of the force.
struct Wrench {
  Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
};

/// Motion of a place of a model (fem/marker.h).
struct PlaceMotion {
  Vec2 position{0, 0}, velocity{0, 0}, acceleration{0, 0};
  Vec2 axis{0, 0};  ///< axis 1; zero for a point of a plate
};

/// All constraint rows of a model at one state.
struct Constraints {
  VectorXd value, rate, acceleration;            ///< (m); see ConstraintRows
  std::vector<Eigen::Triplet<double>> jacobian;  ///< Φ_q
};

/// Bodies, joints and links: the equations of motion
///
///   M(t) q̈ + F(q, q̇, t) + Φ_qᵀ λ = 0,   Φ(q, t) = 0                          P (23)
///
/// A model holds what was added to it and nothing else. Its matrices keep their sparsity pattern
/// until a mesh changes.
///
/// Elements are evaluated eight at a time. Batches of one colour share no unknown, so that threads
/// (OpenMP's) can take them in any order: sums are made colour by colour, and every result is the
/// same bit for bit with any number of threads.
class Model {
 public:
  /// Adds a body; its terms are prepared by the next prepare().
  Body& add_body(std::string name, std::unique_ptr<Element> element, const PlaneSection& section,
                 std::vector<std::unique_ptr<Term>> terms);
  void add_joint(std::unique_ptr<Joint> joint);
  void add_link(std::unique_ptr<Link> link);

  std::vector<Body>& bodies() { return bodies_; }
  const std::vector<Body>& bodies() const { return bodies_; }
  const Body& body(const std::string& name) const;
  const std::vector<std::unique_ptr<Joint>>& joints() const { return joints_; }
  /// First row of joint i in the constraints; first_row(joints().size()) is their number.
  int first_row(size_t joint) const { return first_rows_[joint]; }
  const std::vector<std::unique_ptr<Link>>& links() const { return links_; }

  /// Gives a body another mesh; states of the old one no longer fit (dynamics/growth.h carries
  /// over).
  void set_element(Body& body, std::unique_ptr<Element> element);
  void set_factors(Body& body, Factors factors);

  /// Puts material lines where they are at time t and refreshes what depends on them.
  void prepare(double t);
  /// The same with free material lines where x has them: needed before every evaluation at other
  /// unknowns where has_free_lines().
  void prepare(const State& x);
  bool has_free_lines() const { return !singles_.empty(); }

  /// Multiplies all loads (Term::scale_load) by a factor; 1 until the first call.
  void scale_loads(double factor);
  /// What scale_loads() multiplies, loads and the temperature of hot bodies: both until the first
  /// call.
  void choose_scaled(bool loads, bool temperatures);

  int n_dofs() const { return n_dofs_; }
  int n_constraints() const { return n_constraints_; }

  /// All unknowns of the undeformed model in its own frames (n_dofs), rates zero.
  State reference() const;
  /// Displacement per unit of each unknown's change: element size for slopes (n_dofs) [m^order].
  VectorXd scales() const;

  /// M q̈ + F(q, q̇) without constraint forces (n_dofs); prepare(x.t) first.
  void force(const State& x, VectorXd& out) const;
  void constraints(const State& x, Constraints& out) const;
  /// out += Φ_qᵀ λ.
  void add_constraint_force(const Constraints& c, const VectorXd& lambda, VectorXd& out) const;

  /// Generalized force of joint i alone on all unknowns, -Φ_qᵀ λ (n_dofs).
  VectorXd joint_force(size_t joint, const State& x) const;
  /// What joint i does to a body: resultant force, and moment about a point of the world, by the
  /// virtual work of its force under δr = δ and under δr = θ × (r - about), δr_m = θ × r_m, ...
  /// (plates), δu = θ × u (rigid bodies). Forces on free material lines are no part of it.
  /// @throws Error (input) for a body that does not exist.
  Wrench joint_wrench(size_t joint, const std::string& body, const Vec3& about,
                      const State& x) const;

  /// [ scale · (w.q (F + Φ_qᵀ λ)_q + w.v F_v + w.a M)   Φ_qᵀ ]
  /// [ Φ_q                                              0    ]   in a fixed pattern, which changes
  /// with pattern_version() only.
  void kkt(const State& x, const Constraints& c, const Weights& w, double scale,
           SparseMatrix& out) const;
  /// Counts changes of the pattern: a solver that saw another number must analyse again.
  int pattern_version() const { return pattern_version_; }

  /// Mean force of a step from q₀ to q₁ that keeps the energy, see Term::add_mean_force(); mean:
  /// the mean state, of which prepare(mean.t) was done.
  /// @throws Error (input) when a term has none.
  void mean_force(const State& mean, const VectorXd& q0, const VectorXd& q1, VectorXd& out) const;

  /// [ scale · (F̄ + Φ̄_qᵀ λ)_x   Φ̄_qᵀ ]   the same for the mean force: w are the derivatives of the
  /// [ Φ_q                      0    ]   mean state by x, Φ̄_q is taken there and Φ_q at the end.
  void mean_kkt(const State& mean, const VectorXd& q0, const VectorXd& q1,
                const Constraints& at_mean, const Constraints& at_end, const Weights& w,
                double scale, SparseMatrix& out) const;

  /// Where a place is, and how it moves. For output: looks the place up at every call.
  /// @throws Error (input) as Marker::bind().
  PlaceMotion place_motion(const MarkerPlace& place, const State& x) const;

  Energies energies(const State& x) const;
  /// Linear momentum of the bodies' own mass [kg m/s], see Term::momentum(); z = 0 in the plane.
  Vec3 momentum(const State& x) const;
  /// Power of all links, see Link::power() [W].
  double link_power(const State& x) const;
  /// Power of all terms at fixed unknowns, see Term::flow_power() [W].
  double flow_power(const State& x) const;
  /// Power that the temperature of hot bodies gives to their energy, see StrainTerm::heat_power()
  /// [W].
  double heat_power(const State& x) const;
  /// Power that all terms turn into heat, see Term::dissipation() [W].
  double dissipation(const State& x) const;
  /// Smallest area ratio |r_m x r_n| over all elements (sampled at 3 x 3 points): a collapse of the
  /// St. Venant-Kirchhoff material shows here before Newton fails.
  double smallest_area_ratio(const State& x) const;

 private:
  /// Where eight consecutive elements of a body stand in the vectors and the matrix.
  struct BatchPlaces {
    size_t body = 0;
    int first = 0, count = 0;
    std::vector<int> dofs;     // (n_local, kLanes)
    std::vector<int> entries;  // of the matrix, the first of dim rows: (n_local, n_shapes, kLanes)
  };

  /// An element that is evaluated alone: of a body with free lines.
  struct Single {
    size_t body = 0;
    int e = 0;
    bool free = false;         // are lines around this one free?
    std::vector<int> dofs;     // of the shape unknowns, then of its lines (-1: no unknown)
    std::vector<int> entries;  // of the matrix, by rows (-1: none)
  };

  std::vector<BodyView> views() const;
  void number_dofs();
  void number_batches();
  void number_singles(size_t body);
  void add_single_force(const Single& single, const State& x, VectorXd& out) const;
  void add_single_tangent(const Single& single, const State& x, const Weights& w, double scale,
                          double* values) const;
  void build_pattern() const;
  void joint_stiffness(const State& x, std::vector<Eigen::Triplet<double>>& out) const;
  void gather(const Body& body, int e, const State& x, Local& local) const;
  /// Calls f(batch, its places) for all batches, one colour after the other, by one thread for
  /// every `per_thread` batches.
  template <class F>
  void for_batches(const State& x, int per_thread, const F& f) const;
  void gather(const Body& body, int e, const State& mean, const VectorXd& q0, const VectorXd& q1,
              LocalStep& step) const;
  void clear(SparseMatrix& out) const;
  void add_link_entries(double scale, double* values) const;
  void fill_joints(const State& x, double stiffness_scale, const Constraints& rows,
                   const Constraints& columns, SparseMatrix& out) const;

  std::vector<Body> bodies_;
  std::vector<std::unique_ptr<Joint>> joints_;
  std::vector<int> first_rows_ = {0};
  std::vector<std::unique_ptr<Link>> links_;
  int n_dofs_ = 0, n_constraints_ = 0, pattern_version_ = 0;
  bool scales_loads_ = true, scales_temperatures_ = true;
  bool fresh_ = false;        // terms are prepared for this mesh and these factors
  std::vector<int> colours_;  // first batch of every colour, and their number
  // Pattern of the KKT matrix and where element entries go; rebuilt after a change of the mesh.
  mutable int built_version_ = -1;
  mutable SparseMatrix pattern_;
  mutable std::vector<BatchPlaces> batches_;  // by colours; entries as of the pattern
  mutable std::vector<Single> singles_;
  mutable std::vector<int> joint_places_;      // two per jacobian entry: (row, dof), (dof, row)
  mutable std::vector<int> stiffness_places_;  // of the joints' (Φ_qᵀ λ)_q
  mutable std::vector<Eigen::Triplet<double>> stiffness_;
  mutable ConstraintRows rows_;
  mutable std::vector<int> link_places_;  // of the links' tangents
  mutable std::vector<Eigen::Triplet<double>> link_entries_;
};

}  // namespace flexmorph::fem
