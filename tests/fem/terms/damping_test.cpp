// Shows for plates in the plane and in space and for beams that material damping is right: its
// power agrees with second differences of the elastic energy and with strain rates at points, its
// force is half the derivative of its power, its tangents agree with differences. Shows also that
// rigid motions dissipate nothing, that the mean force dissipates the energy of the balance and
// keeps the momenta, and that the balance holds with material flow.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>

#include "fem/dynamics/starts/start.h"
#include "fem/elements/ancf_beam.h"
#include "fem/model/body_term.h"
#include "fem/terms.h"
#include "tests/support/differences.h"
#include "tests/support/energy_rate.h"
#include "tests/support/errors.h"
#include "tests/support/models.h"
#include "tests/support/sections.h"

namespace flexmorph::fem {
namespace {

using testing::first_difference;
using testing::second_difference;
using testing::ShapeSet;

constexpr double kTime = 2e-3;  // damping time τ [s]

struct DampedTerm {
  std::vector<std::string> elastic;
  TermDomain domain;
  bool designed = false;
};
void PrintTo(const DampedTerm& c, std::ostream* out) {
  for (const std::string& name : c.elastic) *out << name << ' ';
  *out << (c.domain == TermDomain::plane   ? "plane"
           : c.domain == TermDomain::space ? "space"
                                           : "beam")
       << (c.designed ? " designed" : "");
}

class Damping : public ::testing::TestWithParam<DampedTerm> {
 protected:
  Damping() {
    const TermDomain domain = GetParam().domain;
    if (domain == TermDomain::beam)
      element = std::make_unique<AncfBeam>(uniform_nodes(0.6, 3), 0.1,
                                           arc_reference(0.6, std::numbers::pi / 3, 3));
    else
      element =
          std::make_unique<AncfPlate>(domain == TermDomain::plane ? 2 : 3, ShapeSet::h16,
                                      std::vector<MaterialLine>{{0.1, {}}, {0.21, {}}, {0.3, {}}},
                                      std::vector<MaterialLine>{{-0.05, {}}, {0.02, {}}});
    if (GetParam().designed) factors = testing::random_factors(11);
    std::vector<std::string> names = GetParam().elastic;
    names.emplace_back("damping");
    for (auto& term :
         make_terms(names, kThickSection, {{"damping_time", kTime}, {"bending_points", 6}}))
      all.emplace_back(std::move(term));
    for (const auto& term : all) term->prepare(*element, factors, true);
  }
  const BodyTerm& damping() const { return all.back(); }

  MatrixXd random_rows(double size, unsigned seed) const {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> part(-size, size);
    MatrixXd out(element->n_vectors(), element->dim());
    const double length = element->scale(1);
    for (int k = 0; k < element->n_vectors(); ++k)
      for (int c = 0; c < element->dim(); ++c)
        out(k, c) = part(random) * length / element->scale(k);
    return out;
  }
  MatrixXd strained(unsigned seed = 3) const {
    return element->reference() + random_rows(0.1, seed);
  }
  /// Returns a rotation by an angle about an axis that is not a coordinate axis.
  MatrixXd rotation(double angle) const {
    if (element->dim() == 2) return Eigen::Rotation2Dd(angle).toRotationMatrix();
    return Eigen::AngleAxisd(angle, Vec3(1, 2, -1.5).normalized()).toRotationMatrix();
  }
  MatrixXd spin() const {  // derivative of a rotation at rate 1
    return first_difference([&](double h) { return rotation(h); }, 1e-3);
  }
  Local local(int e, const MatrixXd& q, const MatrixXd& v) const {
    return {testing::rows_of_element(*element, q, e), testing::rows_of_element(*element, v, e),
            testing::rows_of_element(*element, 0 * q, e)};
  }
  double power(const MatrixXd& q, const MatrixXd& v) const {
    double out = 0;
    for (int e = 0; e < element->n_elements(); ++e)
      out += damping().dissipative->dissipation(e, local(e, q, v));
    return out;
  }
  double energy(const MatrixXd& q) const {
    double out = 0;
    for (const auto& term : all)
      for (int e = 0; e < element->n_elements(); ++e)
        out += term->strain_energy(e, local(e, q, 0 * q));
    return out;
  }
  VectorXd force(int e, const Local& x) const {
    LocalRows f = LocalRows::Zero(x.q.rows(), x.q.cols());
    damping()->add_force(e, x, f);
    return Eigen::Map<const VectorXd>(f.data(), f.size());
  }

  std::unique_ptr<Element> element;
  ScaleFactors factors;
  std::vector<BodyTerm> all;
};
INSTANTIATE_TEST_SUITE_P(
    Bodies, Damping,
    ::testing::Values(DampedTerm{{"membrane"}, TermDomain::plane},
                      DampedTerm{{"membrane"}, TermDomain::plane, true},
                      DampedTerm{{"membrane", "bending"}, TermDomain::space},
                      DampedTerm{{"membrane", "bending"}, TermDomain::space, true},
                      DampedTerm{{"membrane_assumed", "bending"}, TermDomain::space},
                      DampedTerm{{"gcm"}, TermDomain::beam}, DampedTerm{{"ecm"}, TermDomain::beam},
                      DampedTerm{{"ecm_full"}, TermDomain::beam}));

// In the unstrained state, U(q + h v) = ½ h² ∫ ė·D ė dA + O(h³): its second derivative is P/τ, also
// with scale factors.
TEST_P(Damping, PowerIsTheStiffnessOfTheStrainRates) {
  const MatrixXd turn = rotation(0.7), v = random_rows(1, 5),
                 q = element->reference() * (element->reference().cols() == turn.rows()
                                                 ? MatrixXd(turn.transpose())
                                                 : MatrixXd(turn.transpose().topRows(2)));
  const double by = second_difference([&](double h) { return energy(q + h * v); }, 2e-3);
  EXPECT_NEAR(power(q, v), kTime * by, 1e-8 * kTime * by);
}

// P = v·C(q) v: the force is half its derivative by v, and its power on v is P.
TEST_P(Damping, ForceIsHalfTheDerivativeOfThePower) {
  const MatrixXd q = strained(), v = random_rows(3, 5);
  for (int e = 0; e < element->n_elements(); ++e) {
    const Local x = local(e, q, v);
    const VectorXd f = force(e, x);
    for (Eigen::Index k = 0; k < f.size(); ++k) {
      const double by = first_difference(
          [&](double h) {
            Local moved = x;
            moved.v.data()[k] += h;
            return damping().dissipative->dissipation(e, moved);
          },
          1);
      EXPECT_NEAR(f[k], 0.5 * by, 1e-10 * f.lpNorm<Eigen::Infinity>());
    }
    const double p = damping().dissipative->dissipation(e, x);
    EXPECT_NEAR(f.dot(Eigen::Map<const VectorXd>(x.v.data(), x.v.size())), p, 1e-13 * p);
  }
}

// The expected power uses no closed form: strain rates are central differences of the strain, which
// are exact for Green-Lagrange strains, at 7 x 7 points of every rectangle.
TEST(DampingOfAMembrane, PowerIsThatOfStrainRatesAtPoints) {
  const AncfPlate plate = testing::swinging_plate(ShapeSet::h16);
  const ScaleFactors factors = testing::random_factors(11);
  const auto terms = make_terms(std::vector<std::string>{"membrane", "damping"}, kThickSection,
                                {{"damping_time", kTime}});
  // The lines of this plate move; the test uses their positions at one time.
  const auto still = plate.copy();
  still->move_to(0.4);
  const std::unique_ptr<Element> element = still->frozen();
  const auto& frozen = dynamic_cast<const AncfPlate&>(*element);
  terms[1]->prepare(frozen, factors, true);
  const auto& damping = dynamic_cast<const DissipativeTerm&>(*terms[1]);
  const MatrixXd q = testing::random_shape(frozen, 0.1, 3), v = testing::random_shape(frozen, 1, 7);
  for (int e = 0; e < frozen.n_elements(); ++e) {
    Local x;
    x.q = testing::rows_of_element(frozen, q, e);
    x.v = testing::rows_of_element(frozen, v, e);
    x.a = 0 * x.q;
    const double expected = testing::integrate(
        frozen, e, factors, ScaleFactorKind::stiffness, Tabulate::gradient,
        [&](const ShapeTable& t) {
          const auto strain = [&](double h) {
            const LocalRows at = x.q + h * x.v;
            const Eigen::RowVector2d r_m = t.N_m * at, r_n = t.N_n * at;
            return Vec3(0.5 * r_m.squaredNorm(), 0.5 * r_n.squaredNorm(), r_m.dot(r_n));
          };
          const Vec3 rate = 0.5 * (strain(1) - strain(-1));
          return kTime * kThickSection.thickness * rate.dot(kThickSection.elasticity() * rate);
        });
    EXPECT_NEAR(damping.dissipation(e, x), expected, 1e-11 * expected);
  }
}

// Differences of order 4 are exact except for round-off where strains are quadratic; the curvature
// is not.
TEST_P(Damping, TangentsAreDerivatives) {
  const MatrixXd q = strained(), v = random_rows(3, 5);
  const int e = element->n_elements() - 1;
  const Local x = local(e, q, v);
  for (const Weights w : {Weights{1, 0, 0}, {0, 1, 0}, {0.7, 130, 9e3}}) {
    LocalTangent exact = LocalTangent::Zero(x.q.size(), x.q.size());
    damping()->add_tangent(e, x, w, exact);
    MatrixXd by(x.q.size(), x.q.size());
    const double step = 1e-4 / std::max(w.q, 0.01 * w.v);
    for (Eigen::Index k = 0; k < x.q.size(); ++k)
      by.col(k) = first_difference(
          [&](double h) {
            Local moved = x;
            moved.q.data()[k] += w.q * h;
            moved.v.data()[k] += w.v * h;
            return force(e, moved);
          },
          step);
    EXPECT_LT((exact - by).lpNorm<Eigen::Infinity>(), 1e-8 * by.lpNorm<Eigen::Infinity>());
  }
}

// The limits are relative to the power and the force of a motion of similar speed that is not
// rigid.
TEST_P(Damping, RigidMotionDissipatesNothing) {
  const MatrixXd q = strained(), turned = q * rotation(0.7).transpose();
  MatrixXd v = turned * spin().transpose();
  for (int k = 0; k < element->n_vectors(); ++k)
    if (element->is_position(k)) v.row(k).array() += 2;
  const double unit = power(turned, random_rows(1, 5));
  EXPECT_LT(power(turned, v), 1e-14 * unit);
  const VectorXd f = force(0, local(0, turned, v)),
                 scale = force(0, local(0, turned, random_rows(1, 5)));
  EXPECT_LT(f.norm(), 1e-11 * scale.norm());
}

// The work of the mean force is h P of the mean state, and the momenta do not change. A step that
// rotates the body rigidly by any angle dissipates nothing.
TEST_P(Damping, MeanForceDissipatesWhatTheBalanceCounts) {
  constexpr double h = 0.01;
  const MatrixXd q0 = strained(3), q1 = strained(8);
  const auto step = [&](int e, const MatrixXd& start, const MatrixXd& end) {
    LocalStep x{local(e, start, start).q, local(e, end, end).q,
                local(e, 0.5 * (start + end), (end - start) / h)};
    return x;
  };
  for (int e = 0; e < element->n_elements(); ++e) {
    const LocalStep x = step(e, q0, q1);
    LocalRows f = LocalRows::Zero(x.start.rows(), x.start.cols());
    damping().with_mean_force().add_mean_force(e, x, f);
    const double lost = h * damping().dissipative->dissipation(e, x.mean);
    EXPECT_NEAR(f.cwiseProduct(x.end - x.start).sum(), lost, 1e-13 * lost);
    const auto vectors = element->vectors(e);
    Eigen::RowVectorXd resultant = Eigen::RowVectorXd::Zero(f.cols());
    for (Eigen::Index k = 0; k < f.rows(); ++k)
      if (element->is_position(vectors[static_cast<size_t>(k)])) resultant += f.row(k);
    EXPECT_LT(resultant.norm(), 1e-12 * f.norm());
    const double moment = f.cwiseProduct(LocalRows(x.mean.q * spin().transpose())).sum();
    EXPECT_LT(std::abs(moment), 1e-12 * f.norm() * x.mean.q.norm());
    LocalTangent exact = LocalTangent::Zero(f.size(), f.size());
    damping().with_mean_force().add_mean_tangent(e, x, {0.5, 1 / h, 0}, exact);
    for (Eigen::Index k = 0; k < f.size(); ++k) {
      const VectorXd by = first_difference(
          [&](double by_h) {
            LocalStep moved = x;
            moved.end.data()[k] += by_h;
            moved.mean.q.data()[k] += 0.5 * by_h;
            moved.mean.v.data()[k] += by_h / h;
            LocalRows g = LocalRows::Zero(f.rows(), f.cols());
            damping().with_mean_force().add_mean_force(e, moved, g);
            return VectorXd(Eigen::Map<const VectorXd>(g.data(), g.size()));
          },
          1e-5);
      EXPECT_LT((exact.col(k) - by).lpNorm<Eigen::Infinity>(),
                1e-7 * exact.lpNorm<Eigen::Infinity>());
    }
    const LocalStep rigid = step(e, q0, q0 * rotation(1.1).transpose());
    EXPECT_LT(damping().dissipative->dissipation(e, rigid.mean), 1e-14 * lost / h);
  }
}

// The rates are those of material points, not of nodes: lines at the root and inside move.
TEST(DampingWithFlow, ChangesTheEnergyByThePowers) {
  using Names = std::vector<std::string>;
  for (const Names& names :
       {Names{"inertia", "membrane", "bending", "damping"}, Names{"membrane_assumed", "damping"}})
    for (const bool designed : {false, true}) {
      Workspace model;
      const double points = designed ? 8 : 15;  // for the quadrature of the rational bending energy
      Body& body = model.add_body(
          "plate",
          std::make_unique<AncfPlate>(
              3, ShapeSet::h16,
              std::vector<MaterialLine>{testing::swinging_line(0.1, 0.02, 1.3),
                                        testing::swinging_line(0.21, 0.02, 1.7),
                                        {0.3, {}}},
              testing::uniform_lines(-0.05, 0.07, 2)),
          kThickSection,
          make_terms(names, kThickSection, {{"damping_time", 0.3}, {"bending_points", points}}));
      if (designed) model.set_factors(body, testing::random_factors(5));
      const testing::SmoothMotion motion = testing::any_motion(model);
      for (const double time : {0.3, 0.9}) {
        const auto [rate, work, p] = testing::energy_rate(model, motion, time);
        EXPECT_NEAR(work + p.total(), rate, 1e-8 * (std::abs(work) + std::abs(p.feed)));
        EXPECT_GT(p.loss, 1e-2 * std::abs(rate));
      }
    }
}

// A body that rotates with its frame keeps its strains; therefore it must start in the undamped
// state under its centrifugal forces. Its rates are differences over 1e-4 s.
TEST(DampingAtTheStart, LeavesWhatIsCarriedAsItIs) {
  constexpr double kSpin = 6, kDampingTime = 0.05;  // a wrong rate would be visible at ωτ = 0.3
  testing::RotatingPlate plate;
  plate.speed = 0;
  plate.omega = kSpin;
  plate.nx = 4;
  const BodyPoses nothing_else = [](double) { return std::vector<BodyPose>{}; };
  const auto start = [&](bool damped, double* power) {
    testing::Scene scene = testing::make_scene(plate);
    if (damped)
      scene.model.bodies()[0].terms.push_back(
          std::move(make_terms(std::vector<std::string>{"membrane", "damping"}, plate.section,
                               {{"damping_time", kDampingTime}})
                        .back()));
    const State x =
        start_state(scene.model, scene.moving_roots, 0, Start::prestretched, nothing_else);
    if (power) *power = scene.model.dissipation(x) / scene.model.energies(x).strain;
    return x;
  };
  double power = 0;
  const State free = start(false, nullptr), damped = start(true, &power);
  testing::RotatingPlate rigid = plate;
  testing::Scene scene = testing::make_scene(rigid);
  const State unstrained = start_state(scene.model, scene.moving_roots, 0, Start::rigid);
  EXPECT_LT((damped.q - free.q).norm(), 1e-8 * (free.q - unstrained.q).norm());
  EXPECT_LT((damped.v - free.v).norm(), 1e-5 * (free.v - unstrained.v).norm());
  EXPECT_LT(power, 1e-6 * 2 * kDampingTime * kSpin * kSpin);  // P/U of strains that rotate
}

TEST(DampingTerm, SaysWhatItCannotDo) {
  using Names = std::vector<std::string>;
  const auto error = [](const auto& f) { return testing::error_of(Error::Kind::input, f); };
  const std::string alone = error([] {
    make_terms(Names{"inertia", "damping"}, kThickSection, {{"damping_time", 1}});
  });
  EXPECT_TRUE(testing::mentions(alone, "damping") && testing::mentions(alone, "elastic")) << alone;
  EXPECT_TRUE(testing::mentions(error([] {
                                  make_terms(Names{"membrane", "damping"}, kThickSection, {});
                                }),
                                "damping_time"));
  const auto terms =
      make_terms(Names{"membrane", "damping"}, kThickSection, {{"damping_time", kTime}});
  const AncfPlate free(2, ShapeSet::h16, {{0.1, {}, true}, {0.2, {}}}, {{0, {}}, {0.1, {}}});
  const std::string lines = error([&] { terms[1]->prepare(free, {}, true); });
  EXPECT_TRUE(testing::mentions(lines, "'damping'") && testing::mentions(lines, "material lines"))
      << lines;
}

}  // namespace
}  // namespace flexmorph::fem
