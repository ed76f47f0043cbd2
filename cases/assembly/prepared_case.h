#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <optional>

#include "cases/assembly/build.h"
#include "cases/assembly/resource_estimate.h"

namespace flexmorph::cases {

/// A case with all objects that are expensive to build or must be consistent between their users:
/// one mechanism per mesh, the rigid kinematic model, the design problems, the resource estimate.
/// Each object is built once, at its first use. Users get const references and copy an object
/// before they change it. Several threads may use the case at the same time.
class PreparedCase {
 public:
  /// Creates a prepared case of a scene; nothing else is built yet.
  explicit PreparedCase(Scene scene);

  /// Returns the scene of the case.
  const Scene& scene() const { return parts_->scene; }
  /// Returns the mechanism of a moving scene or of a [static] analysis, with full material and the
  /// settings of its motion. A motion integrates a copy of it.
  /// @throws Error as build_mechanism()
  const Mechanism& mechanism(const MeshChoice& mesh = {}) const;
  /// Returns the rigid kinematic model; null where the scene is no mechanism.
  /// @throws Error as rigid_kinematics()
  const fem::RigidKinematics* rigid() const;
  /// Returns the design problems with their initial layouts, one per designed body. A run optimizes
  /// copies of them.
  /// @throws Error as build_problems()
  const std::vector<mmc::BodyProblem>& design_problems() const;
  /// Returns the estimated size of a run: steps, memory and disk space.
  const ResourceEstimate& resource_estimate() const;

  /// Numbers of objects that have been built.
  struct Counts {
    /// Numbers of mechanisms, of rigid kinematic models and of lists of design problems.
    int mechanisms = 0, rigid = 0, design_problems = 0;
  };
  /// Returns the numbers of objects that have been built so far.
  Counts counts() const;

 private:
  struct Parts {
    explicit Parts(Scene s) : scene(std::move(s)) {}
    const Scene scene;
    std::recursive_mutex lock;
    std::map<MeshChoice, Mechanism> mechanisms;
    std::optional<fem::RigidKinematics> rigid;
    std::optional<std::vector<mmc::BodyProblem>> problems;
    std::optional<ResourceEstimate> resource_estimate;
    Counts counts;
  };
  std::unique_ptr<Parts> parts_;
};

}  // namespace flexmorph::cases
