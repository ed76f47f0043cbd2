#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <optional>

#include "cases/assembly/build.h"
#include "cases/assembly/resource_estimate.h"

namespace flexmorph::cases {

/// A case with everything that is expensive to build from it or must agree between its users: one
/// mechanism per mesh, the rigid kinematic model, the design problems, the resource estimate. Each
/// of them is built at its first use and at most once; users get const references and copy what
/// they change. Several threads may ask at the same time.
class PreparedCase {
 public:
  /// Builds nothing yet.
  explicit PreparedCase(Scene scene);

  const Scene& scene() const { return parts_->scene; }
  /// The mechanism of a scene that moves or of a [static] analysis, with full material and the
  /// settings of its motion. A motion integrates a copy of it.
  /// @throws Error as build_mechanism()
  const Mechanism& mechanism(const MeshChoice& mesh = {}) const;
  /// The rigid kinematic model; null where the scene is no mechanism.
  /// @throws Error as rigid_kinematics()
  const fem::RigidKinematics* rigid() const;
  /// The design problems with their initial layouts, one per designed body. A run designs copies.
  /// @throws Error as build_problems()
  const std::vector<mmc::BodyProblem>& design_problems() const;
  /// What a run takes of time, memory and disk.
  const Extent& extent() const;

  /// How often something was built.
  struct Counts {
    int mechanisms = 0, rigid = 0, design_problems = 0;
  };
  Counts counts() const;

 private:
  struct Parts {
    explicit Parts(Scene s) : scene(std::move(s)) {}
    const Scene scene;
    std::recursive_mutex lock;
    std::map<MeshChoice, Mechanism> mechanisms;
    std::optional<fem::RigidKinematics> rigid;
    std::optional<std::vector<mmc::BodyProblem>> problems;
    std::optional<Extent> extent;
    Counts counts;
  };
  std::unique_ptr<Parts> parts_;
};

}  // namespace flexmorph::cases
