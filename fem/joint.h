#pragma once

#include <Eigen/SparseCore>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "fem/element.h"

namespace flexmorph::fem {

/// Motion of a planar frame: origin [m] and angle [rad] with their rates.
struct FrameMotion {
  Vec2 origin{0, 0}, origin_rate{0, 0}, origin_acceleration{0, 0};
  double angle = 0, angle_rate = 0, angle_acceleration = 0;
};
using FrameDrive = std::function<FrameMotion(double t)>;

/// Rows of one joint at one state.
struct ConstraintRows {
  VectorXd value;         ///< Φ(q, t)
  VectorXd rate;          ///< ∂Φ/∂t
  VectorXd acceleration;  ///< right side of Φ_q q̈ = ..., = -(Φ_q q̇)_q q̇ - 2 Φ_qt q̇ - Φ_tt
  std::vector<Eigen::Triplet<double>> jacobian;  ///< Φ_q: row of the joint, unknown of the model
};

/// What a joint sees of a body.
struct BodyView {
  const std::string* name;
  const Element* element;
  int first_dof;                     ///< number of the body's first unknown in the model
  const Factors* factors = nullptr;  ///< of its design
};

/// The seam of constraints Φ(q, t) = 0.
class Joint {
 public:
  virtual ~Joint() = default;
  /// A copy that shares nothing with this one; to be bound before it is evaluated.
  virtual std::unique_ptr<Joint> clone() const = 0;
  virtual std::string name() const = 0;
  virtual int size() const = 0;  ///< rows
  /// Is it part of a body (its unit axis) rather than of the mechanism? Messages about joints that
  /// hold each other leave it out.
  virtual bool belongs_to_body() const { return false; }

  /// Looks up the unknowns it acts on, by the names of bodies and edges; called again after every
  /// change of a mesh. @throws Error (input) for a body that does not exist.
  virtual void bind(std::span<const BodyView> bodies) = 0;

  /// Fills rows; the places in the jacobian are the same at every call between two bind().
  virtual void evaluate(double t, const VectorXd& q, const VectorXd& v,
                        ConstraintRows& rows) const = 0;

  /// Appends (Φ_qᵀ λ)_q, the part of the tangent that a Φ_q depending on q contributes: places are
  /// unknowns of the model, the same at every call between two bind(). None where Φ is linear in q.
  /// @param lambda  multipliers of this joint's rows (size())
  virtual void add_stiffness(double /*t*/, const VectorXd& /*q*/, const VectorXd& /*lambda*/,
                             std::vector<Eigen::Triplet<double>>& /*out*/) const {}
};

/// The body of that name. @throws Error (input) naming joint and body.
const BodyView& find_body(std::span<const BodyView> bodies, const std::string& joint,
                          const std::string& body);

/// How the root edge sits in its hub (fem/README.md, The weld of an edge).
enum class WeldMode {
  edge,       ///< the edge is straight and across the hub's axis; r_m is free: the material that
              ///< leaves the hub may stretch and shear, as at a clamped edge of the continuum
  direction,  ///< r_m stays parallel to the axis: no shear at the root (first order in mesh size)
  full,       ///< r_m is the unit axis: no root strain at all
  partial     ///< of beams: position and direction of the section only, it may grow and the axis
              ///< stretch: T section 3.3, Fig. 1
};

/// Plate edge welded to a driven frame: for every node, with the axes e₁(t), e₂(t) of the frame,
///
///   r = origin + y e₂,   r_n = e₂                                           (edge)
///   and r_m · e₂ = 0, r_mn · e₂ = 0                                         (direction)
///   or r_m = e₁, r_mn = 0                                                   (full)
///
/// The end of a beam is one node; e₁ is along its r_m in the undeformed beam, and e₂ stands for its
/// r_n there, e₁ in `full` for its r_m (a tapered or sheared reference keeps its own). Besides:
///
///   r = origin, and r_n keeps its direction only                            (partial)
///
/// y is the node's coordinate across. In space the frame turns about z, and the z entries of all
/// these vectors are zero too: the edge is clamped against bending. With the edge "line 3" and a
/// free line the weld is a sleeve: material slides through it. With material flow these rows hold
/// on the moving line, so the rates are total ones along the line: exactly those of the nodal
/// unknowns.
std::unique_ptr<Joint> make_weld(std::string name, std::string body, std::string edge,
                                 FrameDrive frame, WeldMode mode);

/// A free material line of a body (by the number of its scalar unknown) held where the motion says
/// [m]: Φ = p - p(t). Its multiplier is minus the force that the line feels.
std::unique_ptr<Joint> make_line_drive(std::string name, std::string body, int scalar,
                                       std::function<Motion(double)> motion);

/// A material point's position held at a place of the world frame (pin), or driven along a path.
std::unique_ptr<Joint> make_pin(std::string name, std::string body, const Vec2& material,
                                FrameDrive point);

/// Motion of a point, each entry with its rates [m].
using PointDrive = std::function<std::vector<Motion>(double t)>;

/// The same in the plane or in space: those components of the position (all when empty) follow the
/// drive, which returns one Motion per component in their order.
/// @throws Error (input) at bind() for components the body does not have.
std::unique_ptr<Joint> make_pin(std::string name, std::string body, const Vec2& material,
                                PointDrive point, std::vector<int> components);

enum class NodeVector { r, r_m, r_n, r_mn };

/// Nodes of a named edge or, when it has no name, all nodes within a box of material coordinates
/// (low = high: one node, which must be there).
struct HoldPlace {
  std::string edge{};
  Vec2 low{0, 0}, high{0, 0};

  static HoldPlace at(const Vec2& material) { return {{}, material, material}; }
};

/// Components of one kind of vector unknown, held where they are in the undeformed body or at given
/// values.
struct Held {
  HoldPlace at;
  NodeVector vector = NodeVector::r;
  std::vector<int> components{};  ///< 0, 1, 2
  VectorXd value{};               ///< (dim), or empty: reference values
};

/// Holds entries of vector unknowns in the world frame, in the plane and in space: one linear row
/// q_i = value each. An entry that is listed twice (corners of two edges) gets one row.
/// @throws Error (input) at bind() where there is no node, a component is out of range, an entry is
/// held at two values or its material line moves.
std::unique_ptr<Joint> make_hold(std::string name, std::string body, std::vector<Held> held);

/// What a hold takes at an edge of a plate in space that lies in the plane z = 0; lists of several
/// edges are joined for one make_hold().
///
/// clamped    r and the slope along the edge; of the slope across: its z (edge), all but its length
///            (direction), everything (full), see WeldMode
/// supported  z of r and of the slope along the edge: free to turn and to slide in the plane
/// symmetry   the plane through the edge across the plate is a plane of symmetry
std::vector<Held> clamped_edge(const std::string& edge, WeldMode mode = WeldMode::edge);
std::vector<Held> supported_edge(const std::string& edge);
std::vector<Held> symmetry_edge(const std::string& edge);

}  // namespace flexmorph::fem
