#pragma once

#include <limits>

#include "fem/model/model.h"

namespace flexmorph::fem {

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

/// A model of its own together with the room its evaluation takes: what terms keep per element,
/// where the material lines are, the pattern of the matrix. Whoever evaluates a model owns one;
/// several threads, or several motions at the same time, have one each, of copies of one model.
///
/// It is a copy of the whole model and no table of caches beside it, because what is prepared for a
/// state is spread over its parts (lines in elements, invariants and mass matrices in terms, places
/// of markers in joints and links): a part and its caches belong together, and a copy is made once
/// per motion, for less than a step of it costs.
///
/// It knows what it is prepared for: every function first refreshes what the state asks for (time,
/// free material lines) and what was changed in the model (meshes, factors), and nothing else; the
/// pattern of the matrix stays until a mesh changes.
///
/// Elements are evaluated eight at a time. Batches of one colour share no unknown, so that threads
/// (OpenMP's) can take them in any order: sums are made colour by colour, and every result is the
/// same bit for bit with any number of threads.
class Workspace : public Model {
 public:
  Workspace() = default;
  explicit Workspace(Model model) : Model(std::move(model)) {}
  /// The model alone is copied.
  Workspace(const Workspace& other) : Model(other) {}
  Workspace(Workspace&&) = default;
  Workspace& operator=(const Workspace& other) { return *this = Workspace(other); }
  Workspace& operator=(Workspace&&) = default;
  ~Workspace() = default;

  /// Puts material lines, temperatures and all that depends on them where they are at x. Functions
  /// below do it by themselves; it is there for those who read lines from the elements.
  /// @throws Error naming the body where a term cannot be evaluated.
  void prepare(const State& x);
  /// The same at a time, free lines left where they are.
  void prepare(double t);
  /// Puts driven lines where they are at t and leaves the rest to the next evaluation: enough for
  /// rigid bodies and plates to be placed, before terms can be evaluated.
  void move_lines(double t);

  /// Where all parts were prepared last, after the last change of the model: there elements of
  /// equal size (up to round-off) share what is prepared, and go on doing so while only lines move.
  /// Who goes on with a motion, the same bit for bit, begins with it.
  struct Whole {
    double t = 0;               ///< [s]
    std::vector<double> lines;  ///< free ones: q, v, a in turn; empty: where they start
  };
  const Whole& prepared_whole() const { return whole_; }
  void prepare_whole(const Whole& whole);

  /// M q̈ + F(q, q̇) without constraint forces (n_dofs).
  void force(const State& x, VectorXd& out);
  void constraints(const State& x, Constraints& out);
  /// out += Φ_qᵀ λ.
  static void add_constraint_force(const Constraints& c, const VectorXd& lambda, VectorXd& out);

  /// Generalized force of joint i alone on all unknowns, -Φ_qᵀ λ (n_dofs).
  VectorXd joint_force(size_t joint, const State& x);
  /// What joint i does to a body: resultant force, and moment about a point of the world, by the
  /// virtual work of its force under δr = δ and under δr = θ × (r - about), δr_m = θ × r_m, ...
  /// (plates), δu = θ × u (rigid bodies). Forces on free material lines are no part of it.
  /// @throws Error (input) for a body that does not exist.
  Wrench joint_wrench(size_t joint, const std::string& body, const Vec3& about, const State& x);

  /// [ scale · (w.q (F + Φ_qᵀ λ)_q + w.v F_v + w.a M)   Φ_qᵀ ]
  /// [ Φ_q                                              0    ]   in a fixed pattern, which changes
  /// with pattern_version() only.
  void kkt(const State& x, const Constraints& c, const Weights& w, double scale, SparseMatrix& out);

  /// The same of the entries whose row and column are chosen (n_dofs + n_constraints); all others
  /// stay what they are.
  /// @param out  what kkt() made of this pattern_version()
  void renew_kkt(const State& x, const Constraints& c, const Weights& w, double scale,
                 const std::vector<char>& chosen, SparseMatrix& out);
  /// out += (w.q F_q + w.v F_v + w.a M)ᵀ ψ, F of force(), without a matrix.
  /// @param psi, out  (n_dofs)
  void add_transposed_product(const State& x, const Weights& w, const VectorXd& psi, VectorXd& out);

  /// Mean force of a step from q₀ to q₁ that keeps the energy, see MeanForceTerm; mean:
  /// the mean state.
  /// @throws Error (input) when a term has none.
  void mean_force(const State& mean, const VectorXd& q0, const VectorXd& q1, VectorXd& out);

  /// [ scale · (F̄ + Φ̄_qᵀ λ)_x   Φ̄_qᵀ ]   the same for the mean force: w are the derivatives of the
  /// [ Φ_q                      0    ]   mean state by x, Φ̄_q is taken there and Φ_q at the end.
  void mean_kkt(const State& mean, const VectorXd& q0, const VectorXd& q1,
                const Constraints& at_mean, const Constraints& at_end, const Weights& w,
                double scale, SparseMatrix& out);

  /// Where a place is, and how it moves. For output: looks the place up at every call.
  /// @throws Error (input) as Marker::bind().
  PlaceMotion place_motion(const MarkerPlace& place, const State& x) const;

  Energies energies(const State& x);
  /// Of one of its bodies.
  Energies energies(const State& x, const Body& body);
  /// Linear momentum of the bodies' own mass [kg m/s], see Term::momentum(); z = 0 in the plane.
  Vec3 momentum(const State& x);
  /// Lets links that count turns go on from this state: to be called after every accepted step.
  void follow_turns(State& x) const;
  /// Power of all links, see Link::power() [W].
  double link_power(const State& x);
  /// Power of loads that have no potential, see LoadTerm::power() [W].
  double load_power(const State& x);
  /// Power of all terms at fixed unknowns, see FlowTerm [W].
  double flow_power(const State& x);
  /// Power that the temperature of hot bodies gives to their energy, see HeatedTerm::heat_power()
  /// [W].
  double heat_power(const State& x);
  /// Power that all terms turn into heat, see Term::dissipation() [W].
  double dissipation(const State& x);
  /// What derivatives by factors are added to: zeros of every designed body, nothing of others.
  std::vector<FactorSlopes> no_slopes() const;
  /// Adds ψ · ∂F/∂κ, F of force(), by the factors of every body, see DesignedTerm.
  /// @param psi  (n_dofs)   @param out  as no_slopes()
  void add_factor_slopes(const State& x, const VectorXd& psi, std::vector<FactorSlopes>& out);
  /// Strain energy of all bodies, without that of links [J].
  double strain_energy(const State& x);
  /// Adds its derivatives, times weight. @param by_q  (n_dofs)   @param by_factors  as no_slopes()
  void add_strain_slopes(const State& x, double weight, VectorXd& by_q,
                         std::vector<FactorSlopes>& by_factors);
  /// (Φ_qᵀ λ)_q times a vector (n_dofs).
  VectorXd constraint_curvature(const State& x, const VectorXd& lambda, const VectorXd& along);
  /// Smallest area ratio |r_m x r_n| over all elements (sampled at 3 x 3 points): a collapse of the
  /// St. Venant-Kirchhoff material shows here before Newton fails.
  double smallest_area_ratio(const State& x);

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

  bool are_lines_at(const State& x) const;
  void keep_lines(const State& x);
  void prepare_bodies(double t);
  void number_batches();
  void number_singles(size_t body);
  void add_single_force(const Single& single, const State& x, VectorXd& out) const;
  void add_single_tangent(const Single& single, const State& x, const Weights& w, double scale,
                          double* values) const;
  /// Entries of the tangent of a batch, or a single, among the chosen unknowns.
  void renew_batch(const BatchPlaces& places, const State& x, const Weights& w, double scale,
                   const std::vector<char>& chosen, double* values) const;
  void renew_single(const Single& single, const State& x, const Weights& w, double scale,
                    const std::vector<char>& chosen, double* values) const;
  /// Of the tangents of all elements; values do not count.
  std::vector<Eigen::Triplet<double>> element_entries() const;
  void build_pattern();
  void joint_stiffness(const State& x, std::vector<Eigen::Triplet<double>>& out) const;
  static void gather(const Body& body, int e, const State& x, Local& local);
  static void add_energies(const State& x, const Body& body, Energies& out);
  /// Σ of amount(term, element, its unknowns) over the terms that wanted(term) names.
  template <class Wanted, class Amount>
  double summed(const State& x, Wanted wanted, Amount amount);
  static void gather(const Body& body, int e, const State& mean, const VectorXd& q0,
                     const VectorXd& q1, LocalStep& step);
  /// Calls f(batch, its places) for all batches, one colour after the other, by one thread for
  /// every `per_thread` batches.
  template <class F>
  void for_batches(const State& x, int per_thread, const F& f) const;
  void clear(SparseMatrix& out);
  void add_link_entries(double scale, double* values) const;
  void fill_joints(const State& x, double stiffness_scale, const Constraints& rows,
                   const Constraints& columns, SparseMatrix& out);

  // What the parts are prepared for: content of the model, time, free lines (q, v, a in turn).
  int prepared_version_ = -1;
  double prepared_t_ = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> lines_;
  Whole whole_;
  // Batches and singles of the elements, of this pattern_version(); those of one colour follow each
  // other, colours_ has the first batch of every colour, and their number.
  int numbered_version_ = -1;
  std::vector<BatchPlaces> batches_;  // entries as of the pattern
  std::vector<Single> singles_;
  std::vector<int> colours_;
  // Pattern of the KKT matrix and where entries go, of this pattern_version().
  int built_version_ = -1;
  SparseMatrix pattern_;
  std::vector<int> joint_places_;      // two per jacobian entry: (row, dof), (dof, row)
  std::vector<int> stiffness_places_;  // of the joints' (Φ_qᵀ λ)_q
  std::vector<int> link_places_;       // of the links' tangents
  // Room.
  std::vector<Eigen::Triplet<double>> stiffness_, link_entries_;
  ConstraintRows rows_;
};

}  // namespace flexmorph::fem
