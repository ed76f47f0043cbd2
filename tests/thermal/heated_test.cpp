// Shows that a heated term has the energy sᵖ U(F/s), integrated here point by point with F/s for
// every elastic term; that forces, tangents and the power of the heat are its derivatives; that
// batches of eight elements give equal results; and that its mean force is a discrete gradient.
#include "fem/thermal/heated.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "fem/model/body_term.h"
#include "fem/terms.h"
#include "tests/support/differences.h"
#include "tests/support/sections.h"
#include "tests/thermal/hot_models.h"

namespace flexmorph::fem {
namespace {

using testing::first_difference;
using testing::ShapeSet;

constexpr int kElements = 11;  // one full batch and one that is not

struct Case {
  std::string term;
  int dim;
  ThermalVolume volume;
};
void PrintTo(const Case& c, std::ostream* out) {
  *out << c.term << ' ' << c.dim << "d s^" << Heat{0, {}, c.volume}.volume_exponent();
}

bool is_beam(const std::string& term) { return term.substr(1, 2) == "cm"; }

std::unique_ptr<Element> element_of(const Case& c) {
  if (is_beam(c.term)) return std::make_unique<AncfBeam>(1.1, 0.06, kElements);
  return std::make_unique<AncfPlate>(c.dim, ShapeSet::h16,
                                     testing::uniform_lines(0.1, 1.2, kElements),
                                     testing::uniform_lines(-0.02, 0.05, 1));
}

/// Returns heat whose stretch s rises and falls with a rate.
Heat heat_for(ThermalVolume volume) {
  return testing::heat_of(
      [](double t) {
        return Motion{0.05 * std::sin(3 * t), 0.15 * std::cos(3 * t), -0.45 * std::sin(3 * t)};
      },
      volume);
}

/// Returns ½ εᵀ D ε of the gradients divided by s.
double density(const Eigen::Matrix3d& D, const Eigen::RowVectorXd& r_m,
               const Eigen::RowVectorXd& r_n) {
  const Vec3 strain(0.5 * (r_m.squaredNorm() - 1), 0.5 * (r_n.squaredNorm() - 1), r_m.dot(r_n));
  return 0.5 * strain.dot(D * strain);
}

double of_points(const Element& element, int e, const LocalRows& q, double s, int degree,
                 const Eigen::Matrix3d& D) {
  ShapeTable t;
  element.tabulate(e, degree, Tabulate::gradient, {}, ScaleFactorKind::none, t);
  double out = 0;
  for (Eigen::Index p = 0; p < t.weight.size(); ++p)
    out += t.weight[p] * density(D, t.N_m.row(p) * q / s, t.N_n.row(p) * q / s);
  return kThickSection.thickness * out;
}

double of_axis(const Element& element, int e, const LocalRows& q, double s) {
  const double E = kThickSection.youngs_modulus, nu = kThickSection.poisson_ratio, l = 0.1,
               h = 0.06;
  Eigen::Matrix3d D = Eigen::Matrix3d::Zero();
  D.topLeftCorner<2, 2>() << nu * nu, nu, nu, nu * nu;
  D *= E / (1 - nu * nu);
  double out = 0;
  ShapeTable t;
  for (size_t g = 0; g < 9; ++g) {
    element.locate({l * (e + gauss(9).points[g]), 0}, Tabulate::gradient, t);
    out += l * h * gauss(9).weights[g] * density(D, t.N_m.row(0) * q / s, t.N_n.row(0) * q / s);
  }
  return kThickSection.thickness * out;
}

/// Returns the energy of a straight beam with assumed strains of its axis; at the ends of the
/// element gradients are unknowns. D is for all strains, D_axis for the strains of the axis.
double of_assumed(const Element& element, int e, const LocalRows& q, double s,
                  const Eigen::Matrix3d& D, const Eigen::Matrix3d& D_axis) {
  const double l = 0.1, h = 0.06;
  const auto strain = [&](const Eigen::RowVectorXd& r_m, const Eigen::RowVectorXd& r_n) {
    return Vec3(0.5 * ((r_m / s).squaredNorm() - 1), 0.5 * ((r_n / s).squaredNorm() - 1),
                r_m.dot(r_n) / (s * s));
  };
  const auto inside = [&](double x, double y) {
    ShapeTable t;
    element.locate({l * (e + x), y}, Tabulate::gradient, t);
    return strain(t.N_m.row(0) * q, t.N_n.row(0) * q);
  };
  const Vec3 left = strain(q.row(1), q.row(2)), middle = inside(0.5, 0),
             right = strain(q.row(4), q.row(5));
  double out = 0;
  for (size_t g = 0; g < 9; ++g) {
    const double x = gauss(9).points[g];
    Vec3 axis = (2 * x - 1) * (x - 1) * left + 4 * x * (1 - x) * middle + x * (2 * x - 1) * right;
    axis[1] = (1 - x) * left[1] + x * right[1];
    out += 0.5 * l * h * gauss(9).weights[g] * axis.dot(D_axis * axis);
    for (size_t k = 0; k < 9; ++k) {
      const Vec3 all = inside(x, h * (gauss(9).points[k] - 0.5)) - inside(x, 0) + axis;
      out += 0.5 * l * h * gauss(9).weights[g] * gauss(9).weights[k] * all.dot(D * all);
    }
  }
  return kThickSection.thickness * out;
}

double of_samples(const AncfPlate& plate, int e, const LocalRows& q, double s) {
  const auto parabola = [](int i, double x) {
    return i == 0 ? (2 * x - 1) * (x - 1) : i == 1 ? 4 * x * (1 - x) : x * (2 * x - 1);
  };
  const auto strain = [&](double x, double y) {
    ShapeTable t;
    plate.at(e, x, y, Tabulate::gradient, t);
    const Eigen::RowVectorXd r_m = t.N_m * q / s, r_n = t.N_n * q / s;
    return Vec3(0.5 * (r_m.squaredNorm() - 1), 0.5 * (r_n.squaredNorm() - 1), r_m.dot(r_n));
  };
  double out = 0;
  for (size_t g = 0; g < 8; ++g)
    for (size_t h = 0; h < 8; ++h) {
      const double x = gauss(8).points[g], y = gauss(8).points[h];
      Vec3 z = Vec3::Zero();
      for (int i = 0; i < 3; ++i) {
        z[0] += parabola(i, x) * strain(0.5 * i, y)[0];
        z[1] += parabola(i, y) * strain(x, 0.5 * i)[1];
        for (int j = 0; j < 3; ++j)
          z[2] += parabola(i, x) * parabola(j, y) * strain(0.5 * i, 0.5 * j)[2];
      }
      out += 0.1 * 0.07 * gauss(8).weights[g] * gauss(8).weights[h] * 0.5 *
             z.dot(kThickSection.elasticity() * z);
    }
  return kThickSection.thickness * out;
}

/// Returns the energy of P (7), at the 9 x 9 points of the term.
double of_curvature(const Element& element, int e, const LocalRows& q, double s) {
  ShapeTable t;
  element.tabulate(e, 16, Tabulate::curvature, {}, ScaleFactorKind::none, t);
  double out = 0;
  for (Eigen::Index p = 0; p < t.weight.size(); ++p) {
    const auto at = [&](const MatrixXd& table) { return Vec3((table.row(p) * q / s).transpose()); };
    const Vec3 n = at(t.N_m).cross(at(t.N_n));
    const Vec3 k =
        Vec3(at(t.N_mm).dot(n), at(t.N_nn).dot(n), 2 * at(t.N_mn).dot(n)) / std::pow(n.norm(), 3);
    out += 0.5 * t.weight[p] * k.dot(kThickSection.elasticity() * k);
  }
  return std::pow(kThickSection.thickness, 3) / 12 * out;
}

double hot_energy(const Case& c, const Element& element, int e, const LocalRows& q, double s) {
  const double E = kThickSection.youngs_modulus;
  double cold = 0;
  if (c.term == "membrane") cold = of_points(element, e, q, s, 14, kThickSection.elasticity());
  const Eigen::Matrix3d D = kThickSection.elasticity(), D0 = Vec3(E, E, E / 2.6).asDiagonal();
  if (c.term == "gcm") cold = of_assumed(element, e, q, s, D, Eigen::Matrix3d::Zero());
  if (c.term == "ecm") cold = of_assumed(element, e, q, s, D0, D - D0);
  if (c.term == "gcm_full") cold = of_points(element, e, q, s, 8, D);
  if (c.term == "ecm_full") cold = of_points(element, e, q, s, 8, D0) + of_axis(element, e, q, s);
  if (c.term == "membrane_assumed")
    cold = of_samples(dynamic_cast<const AncfPlate&>(element), e, q, s);
  if (c.term == "bending") cold = of_curvature(element, e, q, s);
  return std::pow(s, Heat{0, {}, c.volume}.volume_exponent()) * cold;
}

class HeatedTerm : public ::testing::TestWithParam<Case> {
 protected:
  std::unique_ptr<Element> element = element_of(GetParam());
  BodyTerm term =
      make_heated(make_term(GetParam().term, kThickSection), heat_for(GetParam().volume));

  void SetUp() override { term->prepare(*element, {}, true); }
  double stretch(double t) const { return heat_for(GetParam().volume).stretch(t).value; }

  /// Returns random unknowns of a plate or beam.
  MatrixXd shape(unsigned seed) const {
    const int n = element->n_vectors(), dim = element->dim();
    std::srand(seed);
    MatrixXd q = element->reference();
    const MatrixXd random = MatrixXd::Random(n, dim);
    for (int k = 0; k < n; ++k) q.row(k) += 0.015 / element->scale(k) * random.row(k);
    return q;
  }
  Local local(int e, unsigned seed = 1) const {
    const LocalRows q = testing::rows_of_element(*element, shape(seed), e);
    return {q, 0 * q, 0 * q};
  }
  VectorXd force(int e, const LocalRows& q) const {
    LocalRows f = LocalRows::Zero(q.rows(), q.cols());
    term->add_force(e, {q, 0 * q, 0 * q}, f);
    return Eigen::Map<const VectorXd>(f.data(), f.size());
  }
  double step(Eigen::Index k, int e) const {
    const auto vector = element->vectors(e)[static_cast<size_t>(k / element->dim())];
    return 2e-5 / element->scale(vector);
  }
};

std::vector<Case> all_cases() {
  std::vector<Case> out;
  for (const auto volume :
       {ThermalVolume::grown, ThermalVolume::grown_plane, ThermalVolume::reference}) {
    for (const char* term : {"membrane", "membrane_assumed", "gcm", "ecm", "gcm_full", "ecm_full"})
      out.push_back({term, 2, volume});
    for (const char* term : {"membrane", "membrane_assumed", "bending"})
      out.push_back({term, 3, volume});
  }
  return out;
}
INSTANTIATE_TEST_SUITE_P(All, HeatedTerm, ::testing::ValuesIn(all_cases()));

LocalRows moved(LocalRows q, Eigen::Index k, double by) {
  q.data()[k] += by;
  return q;
}

// Differences of fourth order with steps of 2e-4 of the element have a truncation of 1e-15 times
// the growth of fifth derivatives (large in bending, which is rational) and a round-off of a few
// 1e-16 of the energy.
TEST_P(HeatedTerm, IsTheEnergyOfTheShrunkGradients) {
  const int e = 9;
  const Local x = local(e);
  const Eigen::Index n = x.q.size();
  for (const double t : {0.4, -0.3}) {
    term.heated->heat_to(t);
    const double s = stretch(t), energy = hot_energy(GetParam(), *element, e, x.q, s);
    EXPECT_NEAR(term->strain_energy(e, x), energy, 1e-11 * energy);
    VectorXd gradient(n);
    for (Eigen::Index k = 0; k < n; ++k)
      gradient[k] = first_difference(
          [&](double h) { return hot_energy(GetParam(), *element, e, moved(x.q, k, h), s); },
          step(k, e));
    const VectorXd f = force(e, x.q);
    for (Eigen::Index k = 0; k < n; ++k)
      EXPECT_NEAR(f[k] * step(k, e), gradient[k] * step(k, e),
                  2e-12 * energy + 1e-9 * std::abs(f[k] * step(k, e)))
          << k;
  }
}

TEST_P(HeatedTerm, TangentIsTheDerivativeOfTheForce) {
  const int e = 9;
  const Local x = local(e);
  const Eigen::Index n = x.q.size();
  term.heated->heat_to(0.4);
  LocalTangent exact = LocalTangent::Constant(n, n, 7.0);  // must be added to, not overwritten
  term->add_tangent(e, x, {0.6, 3, 5}, exact);
  exact.array() -= 7.0;
  double largest = 0;
  MatrixXd scaled(n, n), difference(n, n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const VectorXd df =
        first_difference([&](double h) { return force(e, moved(x.q, k, 0.6 * h)); }, step(k, e));
    for (Eigen::Index i = 0; i < n; ++i) {
      scaled(i, k) = exact(i, k) * step(k, e) * step(i, e);
      difference(i, k) = df[i] * step(k, e) * step(i, e);
    }
  }
  largest = scaled.cwiseAbs().maxCoeff();
  EXPECT_LT((scaled - difference).cwiseAbs().maxCoeff(), 1e-8 * largest);
}

TEST_P(HeatedTerm, BatchesAreTheSame) {
  term.heated->heat_to(0.4);
  for (const int first : {0, 8}) {
    Pack q[kMaxShapes * kMaxDim], zero[kMaxShapes * kMaxDim] = {};
    Pack f[kMaxShapes * kMaxDim];
    std::vector<Pack> k(kMaxShapes * kMaxDim * kMaxShapes * kMaxDim);
    Batch x{
        first, std::min(kLanes, kElements - first), element->n_shapes(), element->dim(), q, zero,
        zero};
    const int n = x.n_local();
    for (int lane = 0; lane < kLanes; ++lane) {
      const Local one = local(first + std::min(lane, x.count - 1));
      for (int i = 0; i < n; ++i) q[i][lane] = one.q.data()[i];
    }
    std::fill(f, f + n, Pack{} + 2.0);
    std::fill(k.begin(), k.end(), Pack{} + 3.0);
    term.add_forces(x, f);
    term.add_tangents(x, {0.7, 1, 1}, k.data());
    for (int lane = 0; lane < x.count; ++lane) {
      const Local one = local(first + lane);
      const VectorXd alone = force(first + lane, one.q);
      LocalTangent tangent = LocalTangent::Zero(n, n);
      term->add_tangent(first + lane, one, {0.7, 1, 1}, tangent);
      const double largest = alone.cwiseAbs().maxCoeff(), stiff = tangent.cwiseAbs().maxCoeff();
      for (int i = 0; i < n; ++i) {
        EXPECT_NEAR(f[i][lane] - 2, alone[i], 1e-12 * largest + 1e-14);
        for (int j = 0; j < n; ++j)
          EXPECT_NEAR(k[static_cast<size_t>(j * n + i)][lane] - 3, tangent(i, j), 1e-12 * stiff);
      }
    }
  }
}

TEST_P(HeatedTerm, HeatPowerIsTheRateAtFixedUnknowns) {
  const int e = 3;
  const Local x = local(e);
  for (const double t : {0.4, 0.9}) {
    const double rate = first_difference(
        [&](double dt) {
          term.heated->heat_to(t + dt);
          return term->strain_energy(e, x);
        },
        1e-3);
    term.heated->heat_to(t);
    EXPECT_NEAR(term.heated->heat_power(e, x), rate, 1e-8 * std::abs(rate));
    EXPECT_GT(std::abs(rate), 1e-3 * term->strain_energy(e, x));
    // The power does not depend on the position of the body.
    Local far = x;
    for (Eigen::Index k = 0; k < x.q.rows(); ++k)
      if (element->is_position(element->vectors(e)[static_cast<size_t>(k)]))
        far.q.row(k).array() += 1000.0;
    EXPECT_NEAR(term.heated->heat_power(e, far), rate, 1e-8 * std::abs(rate));
  }
}

// The mean force is a discrete gradient to round-off of the energies, and its tangent is the
// derivative by the end.
TEST_P(HeatedTerm, MeanForceKeepsTheEnergy) {
  const int e = 5;
  term.heated->heat_to(0.4);
  LocalStep x{local(e, 1).q, local(e, 2).q, {}};
  const auto mean = [&](const LocalStep& y) {
    const LocalRows q = 0.5 * (y.start + y.end);
    return Local{q, 0 * q, 0 * q};
  };
  x.mean = mean(x);
  const auto f = [&](const LocalStep& y) {
    LocalRows out = LocalRows::Zero(y.start.rows(), y.start.cols());
    term.with_mean_force().add_mean_force(e, y, out);
    return out;
  };
  const double start = term->strain_energy(e, {x.start, x.mean.v, x.mean.a}),
               end = term->strain_energy(e, {x.end, x.mean.v, x.mean.a});
  EXPECT_NEAR(f(x).cwiseProduct(x.end - x.start).sum(), end - start, 1e-11 * (start + end));
  EXPECT_GT(std::abs(end - start), 1e-3 * (start + end));
  const Eigen::Index n = x.start.size();
  LocalTangent exact = LocalTangent::Zero(n, n);
  term.with_mean_force().add_mean_tangent(e, x, {0.5, 0, 0}, exact);
  MatrixXd scaled(n, n), difference(n, n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const VectorXd df = first_difference(
        [&](double h) {
          LocalStep y = x;
          y.end = moved(x.end, k, h);
          y.mean = mean(y);
          const LocalRows out = f(y);
          return VectorXd(Eigen::Map<const VectorXd>(out.data(), out.size()));
        },
        step(k, e));
    for (Eigen::Index i = 0; i < n; ++i) {
      scaled(i, k) = exact(i, k) * step(k, e) * step(i, e);
      difference(i, k) = df[i] * step(k, e) * step(i, e);
    }
  }
  EXPECT_LT((scaled - difference).cwiseAbs().maxCoeff(), 1e-7 * scaled.cwiseAbs().maxCoeff());
}

}  // namespace
}  // namespace flexmorph::fem
