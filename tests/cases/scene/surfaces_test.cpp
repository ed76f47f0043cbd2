// Shows that rigid_fit() finds the rotation and the translation of points, also where they are
// deformed, and that the parts of displacements sum up to the whole.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "cases/assembly/build.h"
#include "cases/output/rigid_fit.h"
#include "cases/output/surface.h"
#include "io/case_files/case_file.h"

namespace flexmorph::cases {
namespace {

/// Returns some points: a cloud without symmetry.
std::vector<double> cloud(int dim) {
  std::vector<double> out;
  for (int k = 0; k < 30 * dim; ++k)
    out.push_back(std::sin(1.7 * k) + 0.3 * std::cos(0.37 * k * k));
  return out;
}

/// Returns the points after a rotation and a translation, and a stretch along the first axis.
std::vector<double> moved(int dim, const std::vector<double>& from, const RigidFit& by,
                          double stretch) {
  std::vector<double> out;
  const auto d = static_cast<size_t>(dim);
  for (size_t k = 0; k < from.size(); k += d) {
    const Vec3 r = by.rotation * Vec3(stretch * from[k], from[k + 1], dim == 3 ? from[k + 2] : 0) +
                   by.translation;
    for (size_t c = 0; c < d; ++c) out.push_back(r[static_cast<Eigen::Index>(c)]);
  }
  return out;
}

RigidFit motion_of(int dim, double angle) {
  RigidFit out;
  const Vec3 axis = dim == 3 ? Vec3(1, -2, 0.5).normalized() : Vec3(0, 0, 1);
  out.rotation = Eigen::AngleAxisd(angle, axis).toRotationMatrix();
  out.translation = {3, -7, dim == 3 ? 0.4 : 0};
  return out;
}

TEST(RigidFit, FindsRotationsOfAnyAngle) {
  for (const int dim : {2, 3})
    for (const double angle : {0.0, 0.01, 1.0, 2.5, -3.1}) {
      const RigidFit by = motion_of(dim, angle);
      const std::vector<double> from = cloud(dim), to = moved(dim, from, by, 1);
      const RigidFit fit = rigid_fit(dim, from, to);
      EXPECT_LT((fit.rotation - by.rotation).norm(), 1e-13) << dim << ' ' << angle;
      EXPECT_LT((fit.translation - by.translation).norm(), 1e-13) << dim << ' ' << angle;
      for (const double u : split_displacements(dim, from, to).deformation)
        EXPECT_NEAR(u, 0, 1e-13);
    }
}

// The rest of the displacements has no mean and no moment of the first order about the points:
// otherwise another rigid motion would be nearer.
TEST(RigidFit, IsTheNearestRigidMotion) {
  for (const int dim : {2, 3}) {
    const RigidFit by = motion_of(dim, 0.8);
    const std::vector<double> from = cloud(dim), to = moved(dim, from, by, 1.1);
    const SplitDisplacements split = split_displacements(dim, from, to);
    Vec3 sum(0, 0, 0), moment(0, 0, 0);
    double largest = 0;
    const auto d = static_cast<size_t>(dim);
    const auto at = [&](const std::vector<double>& v, size_t k) {
      return Vec3(v[k], v[k + 1], dim == 3 ? v[k + 2] : 0);
    };
    for (size_t k = 0; k < from.size(); k += d) {
      const Vec3 u = at(split.deformation, k), rigid = at(from, k) + at(split.motion, k);
      EXPECT_LT((rigid + u - at(to, k)).norm(), 1e-12);
      sum += u;
      moment += rigid.cross(u);
      largest = std::max(largest, u.norm());
    }
    EXPECT_GT(largest, 0.05);
    EXPECT_LT(sum.norm(), 1e-12);
    EXPECT_LT(moment.norm(), 1e-11);  // 30 points, 10 m from the origin
  }
}

// For a designed plate in motion the energies of its cells sum up to the energy of the plate,
// wherever its root is; displacements refer to the rigid motion of its initial configuration.
TEST(Surfaces, DesignedPlatesShowTheirEnergyAndDisplacement) {
  const Scene scene = read_scene(io::CaseFile(FLEXMORPH_CASES "/rotating_plate_v05.toml"));
  Mechanism mechanism = build_mechanism(scene);
  const Grid& grid = scene.designs[0].grid;
  VectorXd density = VectorXd::LinSpaced(grid.n_cells(), 0.2, 1);
  mechanism.model.set_factors(mechanism.model.bodies()[0], {grid, density, density});
  fem::State x = fem::start_state(mechanism.model, mechanism.moving_roots, 0, fem::Start::rigid,
                                  mechanism.motion.body_poses);
  const fem::Body& body = mechanism.model.body("plate");
  const fem::ReferencePose pose = start_pose(scene, scene.body("plate"));
  mechanism.model.prepare(x);
  const DesignedSurface rigid = designed_surface(body, x, pose, grid, density);
  double largest = 0;
  for (const auto* all : {&rigid.displacement, &rigid.motion})
    for (const double u : *all) largest = std::max(largest, std::abs(u));
  EXPECT_LT(largest, 1e-9);
  // The plate is stretched by 1.5 in x: a point at x = 1.5 X has moved by 0.5 X.
  for (int k = 0; k < body.element->n_vectors(); ++k) x.q[body.first_dof + 2 * k] *= 1.5;
  mechanism.model.prepare(x);
  const DesignedSurface s = designed_surface(body, x, pose, grid, density);
  ASSERT_EQ(s.energy.size(), s.mesh.quads.size());
  ASSERT_EQ(s.displacement.size(), s.mesh.points.size());
  double mean = 0;
  for (size_t k = 0; k < s.mesh.points.size(); k += 2) mean += s.mesh.points[k] / 3;
  mean /= 0.5 * static_cast<double>(s.mesh.points.size());
  for (size_t k = 0; k < s.displacement.size(); k += 2) {
    EXPECT_NEAR(s.motion[k], mean, 1e-9);
    EXPECT_NEAR(s.displacement[k], s.mesh.points[k] / 3 - mean, 1e-9);
    for (const double y : {s.motion[k + 1], s.displacement[k + 1]}) EXPECT_NEAR(y, 0, 1e-9);
  }
  // Green strain (1.5² - 1)/2 in x, held across: S_xx = E/(1 - nu²) 0.625, S_yy = nu S_xx.
  const Body& plate = scene.body("plate");
  const double nu = plate.poisson_ratio,
               stress = plate.youngs_modulus / (1 - nu * nu) * 0.625 * std::sqrt(1 - nu + nu * nu);
  const std::vector<Vec2> middles(s.middles.begin(), s.middles.begin() + 20);
  for (const double each : membrane_stress(body, x, middles, plate.youngs_modulus, nu, 1))
    EXPECT_NEAR(each, stress, 1e-9 * stress);
  double sum = 0;
  for (const double each : s.energy) sum += each * grid.dx() * grid.dy();
  const double whole = mechanism.model.energies(x).strain;
  EXPECT_GT(whole, 0);
  EXPECT_NEAR(sum, whole, 1e-9 * whole);
}

}  // namespace
}  // namespace flexmorph::cases
