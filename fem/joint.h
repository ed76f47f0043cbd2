#pragma once

#include <Eigen/SparseCore>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "fem/element.h"

namespace flexmorph::fem {

/// Motion of a planar frame: origin and angle with their rates and accelerations.
struct FrameMotion {
  /// Position [m], velocity [m/s] and acceleration [m/s²] of the origin.
  Vec2 origin{0, 0}, origin_rate{0, 0}, origin_acceleration{0, 0};
  /// Angle [rad], angular velocity [rad/s] and angular acceleration [rad/s²].
  double angle = 0, angle_rate = 0, angle_acceleration = 0;
};
/// Prescribed motion of a planar frame as a function of time [s].
using FrameDrive = std::function<FrameMotion(double t)>;

/// The constraint rows of one joint at one state.
struct ConstraintRows {
  VectorXd value;  ///< Constraint values Φ(q, t) (size()).
  VectorXd rate;   ///< Partial derivatives ∂Φ/∂t (size()).

  /// Right side c of Φ_q q̈ = c, that is c = -(Φ_q q̇)_q q̇ - 2 Φ_qt q̇ - Φ_tt (size()).
  VectorXd acceleration;
  /// Entries of Φ_q: row of the joint, unknown of the model, value.
  std::vector<Eigen::Triplet<double>> jacobian;
};

/// The data of a body that joints and force elements use.
struct BodyView {
  const std::string* name;                ///< Name of the body.
  const Element* element;                 ///< Elements of the body.
  int first_dof;                          ///< Number of the first unknown of the body in the model.
  const ScaleFactors* factors = nullptr;  ///< Scale factors of the design of the body.
};

/// Interface of a joint: constraint rows Φ(q, t) = 0.
class Joint {
 public:
  virtual ~Joint() = default;
  /// Returns a copy that shares no data with this joint; call bind() before it is evaluated.
  virtual std::unique_ptr<Joint> clone() const = 0;
  /// Returns the name of the joint, which messages use.
  virtual std::string name() const = 0;
  /// Returns the number of constraint rows.
  virtual int size() const = 0;
  /// Returns true if the joint belongs to a body (the unit axis of a rigid body) and not to the
  /// mechanism. Messages about redundant joints do not mention it.
  virtual bool belongs_to_body() const { return false; }

  /// Finds the unknowns of the joint by the names of bodies and edges; it is called again after
  /// every change of a mesh.
  /// @throws Error (input) for a body that does not exist.
  virtual void bind(std::span<const BodyView> bodies) = 0;

  /// Fills the rows; the entries of the jacobian have the same positions at every call between two
  /// calls of bind().
  virtual void evaluate(double t, const VectorXd& q, const VectorXd& v,
                        ConstraintRows& rows) const = 0;

  /// Appends (Φ_qᵀ λ)_q, the contribution to the tangent of a Φ_q that depends on q. Positions are
  /// unknowns of the model and stay the same at every call between two calls of bind(). There are
  /// no entries where Φ is linear in q.
  /// @param lambda  multipliers of the rows of this joint (size())
  virtual void add_stiffness(double /*t*/, const VectorXd& /*q*/,
                             [[maybe_unused]] const VectorXd& lambda,
                             std::vector<Eigen::Triplet<double>>& /*out*/) const {}
};

/// Returns the body of that name.
/// @throws Error (input) naming joint and body.
const BodyView& find_body(std::span<const BodyView> bodies, const std::string& joint,
                          const std::string& body);

/// Boundary condition of a root edge at its hub, the rigid frame with prescribed motion that
/// carries the body (fem/README.md, The weld of an edge).
enum class WeldMode {
  /// The edge stays straight and normal to the axis of the hub; r_m is free. The material at the
  /// edge may stretch and shear, as at a clamped edge of the continuum.
  edge,
  /// The vector r_m stays parallel to the axis: no shear at the root (converges with first order in
  /// the mesh size).
  direction,
  /// The vector r_m is the unit axis: no strain at the root at all.
  full,
  /// For beams: only the position and the direction of the section are prescribed; the section may
  /// change its height and the axis may stretch. T section 3.3, Fig. 1.
  partial
};

/// Creates a joint that welds a plate edge to a frame with prescribed motion. For every node of the
/// edge, with the axes e₁(t), e₂(t) of the frame,
///
///   r = origin + y e₂,   r_n = e₂                                           (edge)
///   and r_m · e₂ = 0, r_mn · e₂ = 0                                         (direction)
///   or r_m = e₁, r_mn = 0                                                   (full)
///
/// The end of a beam is one node; e₁ is along its r_m in the undeformed beam, and the reference
/// vectors replace e₂ for its r_n and, in `full`, e₁ for its r_m (a tapered or sheared reference
/// keeps its own vectors). For beams there is also the mode
///
///   r = origin, and only the direction of r_n is prescribed                 (partial)
///
/// y is the coordinate of the node across the plate. In space the frame turns about z, and the z
/// entries of all these vectors are zero, too, so that the edge is clamped against bending. With
/// the edge "line 3" and a free line the weld is a sleeve, through which material slides. With
/// material flow these rows hold on the moving line; therefore the rates are total rates along the
/// line, which are exactly the rates of the nodal unknowns.
std::unique_ptr<Joint> make_weld(std::string name, std::string body, std::string edge,
                                 FrameDrive frame, WeldMode mode);

/// Creates a joint that prescribes the material coordinate of a free line of a body (given by the
/// number of its scalar unknown) as motion(t) [m]: Φ = p - p(t), 1 row. The multiplier is the
/// negative of the force on the line.
std::unique_ptr<Joint> make_line_drive(std::string name, std::string body, int scalar,
                                       std::function<Motion(double)> motion);

/// Creates a joint that prescribes the position of a material point in the plane as the origin of a
/// moving frame: a fixed pin, or a drive along a path.
std::unique_ptr<Joint> make_pin(std::string name, std::string body, const Vec2& material,
                                FrameDrive point);

/// Motion of a point as a function of time, each component with its rates [m].
using PointDrive = std::function<std::vector<Motion>(double t)>;

/// Creates a joint that prescribes components of the position of a material point in the plane or
/// in space (all if `components` is empty); the drive returns one Motion per component in the order
/// of `components`.
/// @throws Error (input) at bind() for components the body does not have.
std::unique_ptr<Joint> make_pin(std::string name, std::string body, const Vec2& material,
                                PointDrive point, std::vector<int> components);

/// Kinds of vector unknowns of a node.
enum class NodeVector { r, r_m, r_n, r_mn };

/// Nodes that a hold acts on: the nodes of a named edge or, without a name, all nodes within a box
/// of material coordinates (low = high: exactly one node, which must exist).
struct HoldLocation {
  std::string edge{};          ///< Name of the edge, or empty.
  Vec2 low{0, 0}, high{0, 0};  ///< Corners of the box of material coordinates [m].

  /// Returns the location of the node at the given material coordinates [m].
  static HoldLocation at(const Vec2& material) { return {{}, material, material}; }
};

/// Components of one kind of vector unknown that are held at given values, or at their values in
/// the undeformed body.
struct Held {
  HoldLocation at;                    ///< Nodes whose unknowns are held.
  NodeVector vector = NodeVector::r;  ///< Kind of vector unknown.
  std::vector<int> components{};      ///< Held components (0, 1, 2).
  VectorXd value{};  ///< Prescribed values (dim), or empty for the reference values.
};

/// Creates a joint that holds entries of vector unknowns in the world frame, in the plane and in
/// space, with one linear row q_i = value for each entry. An entry that is listed twice (corners of
/// two edges) gets one row.
/// @throws Error (input) at bind() where there is no node, a component is out of range, an entry is
/// held at two values or its material line moves.
std::unique_ptr<Joint> make_hold(std::string name, std::string body, std::vector<Held> held);

/// Returns the entries that clamp an edge of a plate in space that lies in the plane z = 0: the
/// position r and the position gradient along the edge, and of the position gradient across the
/// edge its z entry (mode edge), all but the entry across the edge (direction), or everything
/// (full), see WeldMode. Lists of several edges are joined for one make_hold().
std::vector<Held> clamped_edge(const std::string& edge, WeldMode mode = WeldMode::edge);
/// Returns the entries that simply support an edge of a plate in space: the z entries of r and of
/// the position gradient along the edge, so that the edge may turn, and slide in the plane.
std::vector<Held> supported_edge(const std::string& edge);
/// Returns the entries that make the plane through the edge, normal to the plate, a plane of
/// symmetry.
std::vector<Held> symmetry_edge(const std::string& edge);

}  // namespace flexmorph::fem
