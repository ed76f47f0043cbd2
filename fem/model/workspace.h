#pragma once

#include <limits>

#include "fem/model/model.h"

namespace flexmorph::fem {

/// A force with a moment about a point; in the plane the force has no z entry and the moment only a
/// z entry.
struct Wrench {
  Vec3 force = Vec3::Zero(), moment = Vec3::Zero();  ///< Force [N] and moment [N m].
};

/// Motion of a marker location of a model (fem/marker.h).
struct LocationMotion {
  /// Position [m], velocity [m/s] and acceleration [m/s²].
  Vec2 position{0, 0}, velocity{0, 0}, acceleration{0, 0};
  Vec2 axis{0, 0};  ///< Axis 1 [-]; zero for a point of a plate.
};

/// All constraint rows of a model at one state.
struct Constraints {
  VectorXd value, rate, acceleration;            ///< See ConstraintRows (n_constraints each).
  std::vector<Eigen::Triplet<double>> jacobian;  ///< Entries of Φ_q.
};

/// A copy of a model together with the data that its evaluation needs: data of terms per element,
/// positions of the material lines, the pattern of the matrix. Every evaluation of a model uses its
/// own workspace; several threads, or several motions at the same time, have one workspace each,
/// with copies of one model.
///
/// A workspace is a copy of the whole model and not a table of caches, because the data that are
/// prepared for a state are distributed over the objects of the model (lines in elements,
/// invariants and mass matrices in terms, positions of markers in joints and force elements). The
/// copy is made once per motion and costs less than one time step.
///
/// A workspace stores the state for which it is prepared. Every function first updates what depends
/// on the state (time, free lines) and what was changed in the model (meshes, scale factors), and
/// nothing else; the pattern of the matrix stays until a mesh changes.
///
/// Elements are evaluated in batches of eight. Batches of one colour share no unknown, so that
/// OpenMP threads can evaluate them in any order. Sums are formed colour by colour; therefore every
/// result is bitwise identical for any number of threads.
class Workspace : public Model {
 public:
  Workspace() = default;
  /// Creates a workspace of a model.
  explicit Workspace(Model model) : Model(std::move(model)) {}
  /// Creates a workspace of a copy of the model; the prepared data are not copied.
  Workspace(const Workspace& other) : Model(other) {}
  Workspace(Workspace&&) = default;
  Workspace& operator=(const Workspace& other) { return *this = Workspace(other); }
  Workspace& operator=(Workspace&&) = default;
  ~Workspace() = default;

  /// Prepares material lines, temperatures and all data that depend on them for state x. The
  /// functions below call it; a direct call is needed only to read lines from the elements.
  /// @throws Error naming the body where a term cannot be evaluated.
  void prepare(const State& x);
  /// Prepares the model for time t [s] and leaves the free lines unchanged.
  void prepare(double t);
  /// Moves driven lines to time t [s] and leaves all other preparation to the next evaluation. This
  /// suffices to place rigid bodies and plates before terms can be evaluated.
  void move_lines(double t);

  /// Time and free lines of the last preparation of all elements, which follows every change of the
  /// model. In that preparation elements of equal size (up to round-off) share their data, and they
  /// continue to share them while only lines move. A motion that is continued bit for bit must
  /// start from this preparation.
  struct CacheCheckpoint {
    double t = 0;  ///< Time [s].

    /// Free lines (q, v, a of each in turn); empty for their initial coordinates.
    std::vector<double> lines;
  };
  /// Returns the last preparation of all elements.
  const CacheCheckpoint& cache_checkpoint() const { return checkpoint_; }
  /// Repeats a preparation of all elements.
  void restore_cache(const CacheCheckpoint& whole);

  /// Evaluates M q̈ + F(q, q̇) without constraint forces (n_dofs).
  void force(const State& x, VectorXd& out);
  /// Evaluates the constraint rows. Rows that are left out (Model::leave_out()) are 0, with an
  /// entry 0 at each place of their Jacobian.
  void constraints(const State& x, Constraints& out);
  /// Evaluates all constraint rows, also those that are left out of constraints().
  void all_constraints(const State& x, Constraints& out);
  /// Adds the constraint force: out += Φ_qᵀ λ.
  static void add_constraint_force(const Constraints& c, const VectorXd& lambda, VectorXd& out);

  /// Returns the generalized force of one joint alone on all unknowns, -Φ_qᵀ λ (n_dofs).
  VectorXd joint_force(size_t joint, const State& x);
  /// Returns the resultant force of a joint on a body, and its moment about a point `about` of the
  /// world [m]. They follow from the virtual work of the joint force under δr = δ and under δr = θ
  /// × (r - about), δr_m = θ × r_m, ... (plates), δu = θ × u (rigid bodies). Forces on free lines
  /// are not included.
  /// @throws Error (input) for a body that does not exist.
  Wrench joint_wrench(size_t joint, const std::string& body, const Vec3& about, const State& x);

  /// Assembles the iteration matrix in a fixed pattern, which changes with pattern_version() only:
  ///
  /// [ scale · (w.q (F + Φ_qᵀ λ)_q + w.v F_v + w.a M)   Φ_qᵀ ]
  /// [ Φ_q                                              0    ]
  ///
  /// Rows of Φ_q that are left out have an entry 1 on the diagonal alone.
  void kkt(const State& x, const Constraints& c, const Weights& w, double scale, SparseMatrix& out);

  /// Recomputes the entries of the iteration matrix whose row and column are both chosen; all other
  /// entries keep their values.
  /// @param chosen  nonzero for a chosen row or column (n_dofs + n_constraints)
  /// @param out     a matrix of kkt() for this pattern_version()
  void renew_kkt(const State& x, const Constraints& c, const Weights& w, double scale,
                 const std::vector<char>& chosen, SparseMatrix& out);
  /// Adds (w.q F_q + w.v F_v + w.a M)ᵀ ψ to `out` without assembling a matrix, with F of force().
  /// @param psi, out  (n_dofs)
  void add_transposed_product(const State& x, const Weights& w, const VectorXd& psi, VectorXd& out);

  /// Evaluates the energy-conserving mean force of a step from q₀ to q₁, see MeanForceTerm.
  /// @param mean  the mean state
  /// @throws Error (input) when a term has no mean force.
  void mean_force(const State& mean, const VectorXd& q0, const VectorXd& q1, VectorXd& out);

  /// Assembles the iteration matrix of the mean force. The weights w are the derivatives of the
  /// mean state by x; Φ̄_q is taken at the mean state and Φ_q at the end of the step:
  ///
  /// [ scale · (F̄ + Φ̄_qᵀ λ)_x   Φ̄_qᵀ ]
  /// [ Φ_q                      0    ]
  void mean_kkt(const State& mean, const VectorXd& q0, const VectorXd& q1,
                const Constraints& at_mean, const Constraints& at_end, const Weights& w,
                double scale, SparseMatrix& out);

  /// Returns the motion of a marker location. It is meant for output, because it looks up the
  /// location at every call.
  /// @throws Error (input) as Marker::bind().
  LocationMotion location_motion(const MarkerLocation& location, const State& x) const;

  /// Returns the energies of all bodies and force elements [J].
  Energies energies(const State& x);
  /// Returns the energies of one body [J].
  Energies energies(const State& x, const Body& body);
  /// Returns the linear momentum of the masses of the bodies [kg m/s], see Term::momentum(); z = 0
  /// in the plane.
  Vec3 momentum(const State& x);
  /// Stores the counted angles of the force elements in x.turned; call it after every accepted
  /// step.
  void follow_turns(State& x) const;
  /// Returns the power of all force elements, see ForceElement::power() [W].
  double force_element_power(const State& x);
  /// Returns the power of loads without a potential, see LoadTerm::power() [W].
  double load_power(const State& x);
  /// Returns the power of material flow of all terms at fixed unknowns, see FlowTerm [W].
  double flow_power(const State& x);
  /// Returns the power that changes of temperature supply to the bodies, see
  /// HeatedTerm::heat_power() [W].
  double heat_power(const State& x);
  /// Returns the dissipated power of all terms, see DissipativeTerm::dissipation() [W].
  double dissipation(const State& x);
  /// Returns initial gradients by the scale factors, one per body: zeros for a designed body, empty
  /// vectors for other bodies.
  std::vector<ScaleFactorGradient> zero_scale_factor_gradients() const;
  /// Adds the gradient of ψ · F with respect to the scale factors of every body, with F of force(),
  /// see DesignedTerm.
  /// @param psi  (n_dofs)
  /// @param out  gradients in the form of zero_scale_factor_gradients()
  void add_scale_factor_gradient(const State& x, const VectorXd& psi,
                                 std::vector<ScaleFactorGradient>& out);
  /// Returns the strain energy of all bodies, without force elements [J].
  double strain_energy(const State& x);
  /// Adds the derivatives of strain_energy() times weight.
  /// @param by_q        derivatives by the unknowns (n_dofs)
  /// @param d_factors  gradients in the form of zero_scale_factor_gradients()
  void add_strain_energy_gradient(const State& x, double weight, VectorXd& by_q,
                                  std::vector<ScaleFactorGradient>& d_factors);
  /// Returns (Φ_qᵀ λ)_q times a vector (n_dofs).
  VectorXd constraint_curvature(const State& x, const VectorXd& lambda, const VectorXd& along);
  /// Returns the smallest area ratio over all elements (r_m × r_n in the plane, |r_m × r_n| in
  /// space, sampled at 3 x 3 points). A small ratio indicates a collapse of the St.
  /// Venant-Kirchhoff material before Newton's method fails.
  double smallest_area_ratio(const State& x);

 private:
  /// Positions of eight consecutive elements of a body in the vectors and in the value array of the
  /// matrix.
  struct BatchIndices {
    size_t body = 0;
    int first = 0, count = 0;
    std::vector<int> dofs;  // unknowns of the model (n_local, kLanes)
    /// Positions of the first of dim rows in the value array (n_local, n_shapes, kLanes).
    std::vector<int> entries;
  };

  /// An element that is evaluated alone because its body has free lines.
  struct Single {
    size_t body = 0;
    int e = 0;
    bool free = false;         // true if lines around this element are free
    std::vector<int> dofs;     // shape unknowns, then lines (-1: no unknown)
    std::vector<int> entries;  // positions in the value array, by rows (-1: none)
  };

  bool are_lines_at(const State& x) const;
  void keep_lines(const State& x);
  void prepare_bodies(double t);
  void number_batches();
  void number_singles(size_t body);
  void add_single_force(const Single& single, const State& x, VectorXd& out) const;
  void add_single_tangent(const Single& single, const State& x, const Weights& w, double scale,
                          double* values) const;
  /// Recomputes the entries of the tangent of a batch among the chosen unknowns.
  void renew_batch(const BatchIndices& value_indices, const State& x, const Weights& w,
                   double scale, const std::vector<char>& chosen, double* values) const;
  /// Recomputes the entries of the tangent of a single element among the chosen unknowns.
  void renew_single(const Single& single, const State& x, const Weights& w, double scale,
                    const std::vector<char>& chosen, double* values) const;
  /// Returns the positions of the tangents of all elements; the values have no meaning.
  std::vector<Eigen::Triplet<double>> element_entries() const;
  void build_pattern();
  void joint_stiffness(const State& x, std::vector<Eigen::Triplet<double>>& out) const;
  static void gather(const Body& body, int e, const State& x, Local& local);
  static void add_energies(const State& x, const Body& body, Energies& out);
  /// Returns the sum of amount(term, element, its unknowns) over the terms for which wanted(term)
  /// is true.
  template <class Wanted, class Amount>
  double summed(const State& x, Wanted wanted, Amount amount);
  static void gather(const Body& body, int e, const State& mean, const VectorXd& q0,
                     const VectorXd& q1, LocalStep& step);
  /// Calls f(batch, its positions) for all batches, one colour after the other, with one thread for
  /// every `per_thread` batches.
  template <class F>
  void for_batches(const State& x, int per_thread, const F& f) const;
  void clear(SparseMatrix& out);
  void add_force_element_entries(double scale, double* values) const;
  void fill_joints(const State& x, double stiffness_scale, const Constraints& rows,
                   const Constraints& columns, SparseMatrix& out);

  // The state of the last preparation: content of the model, time, free lines (q, v, a in turn).
  int prepared_version_ = -1;
  double prepared_t_ = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> lines_;
  CacheCheckpoint checkpoint_;
  // Batches and single elements, numbered for the pattern_version() numbered_version_. Batches of
  // one colour follow each other; colours_ has the index of the first batch of every colour, and at
  // its end the number of batches.
  int numbered_version_ = -1;
  std::vector<BatchIndices> batches_;  // with the positions of the current pattern
  std::vector<Single> singles_;
  std::vector<int> colours_;
  // Pattern of the iteration matrix and positions in its value array, for the pattern_version()
  // built_version_.
  int built_version_ = -1;
  SparseMatrix pattern_;
  std::vector<int> joint_indices_;          // two per jacobian entry: (row, dof), (dof, row)
  std::vector<int> left_out_indices_;       // diagonal entries of rows that are left out
  std::vector<int> stiffness_indices_;      // of the joints' (Φ_qᵀ λ)_q
  std::vector<int> force_element_indices_;  // of the tangents of the force elements
  // Work arrays.
  std::vector<Eigen::Triplet<double>> stiffness_, force_element_entries_;
  ConstraintRows rows_;
};

}  // namespace flexmorph::fem
