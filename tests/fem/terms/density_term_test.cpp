// Shows that terms equal their densities: for every elastic row of the table of terms, in the
// plane, in space and on beams, with uniform material and scale factors, with fixed, moving and
// free lines, the closed forms in use have the forces, tangents, energies and powers of the term
// that is made from the density alone. Shows also that the derivatives of strain densities are
// right.
#include "fem/terms/density_term.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "fem/elements/ancf_beam.h"
#include "fem/model/body_term.h"
#include "fem/terms.h"
#include "fem/terms/sampling.h"
#include "tests/support/crooked_beam.h"
#include "tests/support/differences.h"
#include "tests/support/models.h"
#include "tests/support/sections.h"

namespace flexmorph::fem {
namespace {

using testing::first_difference;
using testing::ShapeSet;

struct Case {
  std::string row;
  TermDomain domain;
  ShapeSet shapes = ShapeSet::h16;
  bool designed = false;
  std::string beam = "";
};
void PrintTo(const Case& c, std::ostream* out) {
  *out << c.row << ' ' << c.beam;
  if (c.domain != TermDomain::beam)
    *out << (c.domain == TermDomain::plane ? "plane" : "space")
         << (c.shapes == ShapeSet::h12 ? " h12" : " h16") << (c.designed ? " designed" : "");
}

/// Returns every elastic row with every domain that it supports.
std::vector<Case> cases() {
  std::vector<Case> out;
  for (const TermRow* row : term_rows()) {
    if (!row->elastic) continue;
    for (const TermDomain domain : row->domains) {
      if (domain == TermDomain::beam)
        for (const char* beam : {"straight", "arc", "crooked"})
          out.push_back({row->name, domain, {}, false, beam});
      else
        for (const ShapeSet shapes : {ShapeSet::h12, ShapeSet::h16})
          for (const bool designed : {false, true})
            out.push_back({row->name, domain, shapes, designed});
    }
  }
  return out;
}

std::unique_ptr<Element> element_of(const Case& c, bool still) {
  if (c.beam == "straight") return std::make_unique<AncfBeam>(0.6, 0.1, 3);
  if (c.beam == "arc")
    return std::make_unique<AncfBeam>(uniform_nodes(0.6, 3), 0.1,
                                      arc_reference(0.6, std::numbers::pi / 3, 3));
  if (c.beam == "crooked") return std::make_unique<AncfBeam>(testing::crooked_beam(0.1));
  using testing::swinging_line;
  const auto line = [&](double at, double amplitude, double angular_frequency) {
    return still ? MaterialLine{at, {}} : swinging_line(at, amplitude, angular_frequency);
  };
  return std::make_unique<AncfPlate>(
      c.domain == TermDomain::plane ? 2 : 3, c.shapes,
      std::vector<MaterialLine>{line(0.1, 0.03, 2.1), {0.21, {}}, line(0.3, 0.02, 1.3), {0.45, {}}},
      std::vector<MaterialLine>{{-0.05, {}}, line(0.01, 0.02, 1.7), {0.07, {}}}, 0.4);
}

/// Returns random unknowns of a body, within a fraction of the element size from the reference.
MatrixXd shape(const Element& element, double size, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> part(-size, size);
  MatrixXd out = element.reference();
  const double length = element.scale(1);
  for (int k = 0; k < element.n_vectors(); ++k)
    for (int c = 0; c < element.dim(); ++c) out(k, c) += part(random) * length / element.scale(k);
  return out;
}

/// Returns the densities of a row from their strains and their stiffness only, without closed
/// forms.
std::vector<ElasticPart> plain_parts(const TermRow& row) {
  std::vector<ElasticPart> out = row.elastic({kThickSection, {}, {}});
  for (ElasticPart& part : out) {
    const auto& linear = dynamic_cast<const LinearDensity&>(*part.density);
    part.density = std::make_shared<LinearDensity>(linear.strain(), linear.stiffness());
  }
  return out;
}

/// Returns the largest entry of the difference relative to the largest expected entry.
template <class Matrix>
double relative(const Matrix& is, const Matrix& should) {
  return (is - should).template lpNorm<Eigen::Infinity>() /
         should.template lpNorm<Eigen::Infinity>();
}

class EveryElasticRow : public ::testing::TestWithParam<Case> {
 protected:
  void build(bool still) {
    const TermRow& row = term_row(GetParam().row);
    element = element_of(GetParam(), still);
    if (GetParam().designed) factors = testing::random_factors(11);
    closed = make_term(row.name, kThickSection);
    generic = make_elastic_term(row.name, plain_parts(row));
    for (const BodyTerm* term : {&closed, &generic}) (*term)->prepare(*element, factors, true);
    q = shape(*element, 0.1, 3);
  }
  Local local(int e, const MatrixXd& all) const {
    Local x;
    x.q = testing::rows_of_element(*element, all, e);
    x.v = x.a = LocalRows::Zero(x.q.rows(), x.q.cols());
    return x;
  }
  static LocalRows force(const Term& term, int e, const Local& x) {
    LocalRows out = LocalRows::Zero(x.q.rows(), x.q.cols());
    term.add_force(e, x, out);
    return out;
  }
  static LocalTangent tangent(const Term& term, int e, const Local& x) {
    LocalTangent out = LocalTangent::Zero(x.q.size(), x.q.size());
    term.add_tangent(e, x, {0.7, 0, 0}, out);
    return out;
  }

  std::unique_ptr<Element> element;
  ScaleFactors factors;
  BodyTerm closed;
  BodyTerm generic;
  MatrixXd q;
};
INSTANTIATE_TEST_SUITE_P(Table, EveryElasticRow, ::testing::ValuesIn(cases()));

TEST_P(EveryElasticRow, IsItsDensity) {
  for (const bool still : {true, false}) {
    build(still);
    double worst_force = 0, worst_tangent = 0;
    for (int e = 0; e < element->n_elements(); ++e) {
      const Local x = local(e, q);
      worst_force = std::max(worst_force, relative(force(*generic, e, x), force(*closed, e, x)));
      worst_tangent =
          std::max(worst_tangent, relative(tangent(*generic, e, x), tangent(*closed, e, x)));
      const double energy = closed->strain_energy(e, x);
      EXPECT_NEAR(generic->strain_energy(e, x), energy, 1e-12 * energy);
    }
    EXPECT_LT(worst_force, 1e-12);
    EXPECT_LT(worst_tangent, 1e-10);
  }
}

TEST_P(EveryElasticRow, HasThePowersOfItsDensity) {
  build(false);
  const auto* plate = dynamic_cast<const AncfPlate*>(element.get());
  if (!plate) return;  // no material flows through beams
  const Tabulate what = plate->dim() == 3 ? Tabulate::curvature_rates : Tabulate::gradient_rates;
  for (int e = 0; e < element->n_elements(); ++e) {
    const Local x = local(e, q);
    const double power = closed.flow->flow_power(e, x);
    EXPECT_NEAR(generic.flow->flow_power(e, x), power, 1e-11 * std::abs(power));
    std::vector<ShapeTable> line(7);
    for (size_t g = 0; g < line.size(); ++g) plate->at(e, 0, gauss(7).points[g], what, line[g]);
    LineEnergy is, should;
    is.set_zero(7);
    should.set_zero(7);
    generic.flow->add_line_energy(line, x, is);
    closed.flow->add_line_energy(line, x, should);
    EXPECT_LT(relative(is.stiffness, should.stiffness), 1e-12);
  }
}

// U₁ - U₀ = F̄ · d must hold to the round-off of the energies.
TEST_P(EveryElasticRow, HasAMeanForceThatKeepsTheEnergy) {
  build(true);
  const MatrixXd end = shape(*element, 0.1, 8);
  for (int e = 0; e < element->n_elements(); ++e) {
    LocalStep x{local(e, q).q, local(e, end).q, local(e, 0.5 * (q + end))};
    const double start_energy = generic->strain_energy(e, {x.start, {}, {}}),
                 end_energy = generic->strain_energy(e, {x.end, {}, {}});
    LocalRows mean = LocalRows::Zero(x.start.rows(), x.start.cols());
    generic.with_mean_force().add_mean_force(e, x, mean);
    EXPECT_NEAR(mean.cwiseProduct(x.end - x.start).sum(), end_energy - start_energy,
                1e-11 * (start_energy + end_energy));
  }
}

TEST_P(EveryElasticRow, HasTheForcesOnFreeLinesOfItsDensity) {
  if (!term_row(GetParam().row).eulerian_lines || GetParam().domain == TermDomain::beam ||
      GetParam().designed)
    return;
  const int dim = GetParam().domain == TermDomain::plane ? 2 : 3;
  const auto free = [](std::initializer_list<double> at) {
    std::vector<MaterialLine> out;
    for (const double x : at) out.push_back({x, {}, true});
    return out;
  };
  AncfPlate plate(dim, GetParam().shapes, free({0.1, 0.21}), free({-0.02, 0.05}));
  const BodyTerm closed = make_term(GetParam().row, kThickSection);
  const BodyTerm generic(make_elastic_term(GetParam().row, plain_parts(term_row(GetParam().row))));
  Local x;
  x.q = testing::rows_of_element(plate, shape(plate, 0.1, 3), 0);
  x.v = x.a = LocalRows::Zero(x.q.rows(), x.q.cols());
  const Eigen::Index n = x.q.size() + kSides;
  EulerianForce forces[2];
  EulerianTangent tangents[2];
  int i = 0;
  for (const BodyTerm* term : {&closed, &generic}) {
    (*term)->prepare(plate, {}, true);
    forces[i].setZero(n);
    tangents[i].setZero(n, n);
    term->with_eulerian_lines().add_eulerian_force(0, x, forces[i]);
    term->with_eulerian_lines().add_eulerian_tangent(0, x, {1, 0, 0}, tangents[i]);
    ++i;
  }
  EXPECT_LT(relative(forces[1], forces[0]), 1e-12);
  EXPECT_LT(relative(tangents[1], tangents[0]), 1e-10);
  EXPECT_NEAR(generic->strain_energy(0, x) / closed->strain_energy(0, x), 1, 1e-12);
}

// Strains are smooth functions of their measures: differences of fourth order have errors of
// (1e-3)⁴ at most.
TEST(StrainMeasures, VariationsAreDerivatives) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> part(-0.3, 0.3);
  for (const StrainMeasure* measure : {&green_lagrange(), &plate_curvature()}) {
    const auto n = static_cast<Eigen::Index>(measure->measures().size());
    Measures z(n, 3);
    for (double& x : z.reshaped()) x = part(random);
    z.topLeftCorner(2, 2) += Eigen::Matrix2d::Identity();
    StrainVector e;
    StrainVariation B;
    measure->strain(z, e, &B);
    MeasureHessian second;
    for (Eigen::Index k = 0; k < z.size(); ++k) {
      const auto moved = [&](double h) {
        Measures out = z;
        out.data()[k] += h;
        return out;
      };
      const auto strain = [&](double h) {
        StrainVector at;
        measure->strain(moved(h), at, nullptr);
        return VectorXd(at);
      };
      const auto variation = [&](double h) {
        StrainVector at;
        StrainVariation out;
        measure->strain(moved(h), at, &out);
        return MatrixXd(out);
      };
      EXPECT_LT((first_difference(strain, 1e-3) - B.col(k)).norm(), 1e-9);
      const MatrixXd by = first_difference(variation, 1e-3);
      for (int i = 0; i < measure->size(); ++i) {
        measure->second_variation(i, z, second);
        EXPECT_LT((by.row(i) - second.row(k)).norm(), 1e-8);
      }
    }
  }
}

/// The density W = k Σ (cosh e_i - 1), which is not quadratic.
class Cosh final : public StrainDensity {
 public:
  Cosh() : StrainDensity(green_lagrange()) {}
  double of_strain(const StrainVector& e, StrainVector* stress,
                   StrainSquare* stiffness) const override {
    if (stress) *stress = kScale * e.array().sinh().matrix();
    if (stiffness) *stiffness = kScale * e.array().cosh().matrix().asDiagonal().toDenseMatrix();
    return kScale * (e.array().cosh() - 1).sum();
  }
  static constexpr double kScale = 1e6;
};

// A density is sufficient for a new term: its force and tangent are derivatives of its energy.
TEST(ElasticTerm, IsMadeFromAnyDensity) {
  const AncfPlate plate = testing::swinging_plate(ShapeSet::h16, 0.4);
  const BodyTerm term(make_elastic_term(
      "cosh", {{std::make_shared<Cosh>(), sample_points(12, Tabulate::gradient)}}));
  term->prepare(plate, {}, true);
  Local x;
  x.q = testing::rows_of_element(plate, testing::random_shape(plate, 0.1, 3), 1);
  x.v = x.a = LocalRows::Zero(x.q.rows(), 2);
  LocalRows force = LocalRows::Zero(x.q.rows(), 2);
  LocalTangent tangent = LocalTangent::Zero(x.q.size(), x.q.size());
  term->add_force(1, x, force);
  term->add_tangent(1, x, {1, 0, 0}, tangent);
  const double largest = force.lpNorm<Eigen::Infinity>();
  for (Eigen::Index k = 0; k < x.q.size(); ++k) {
    const auto moved = [&](double h) {
      Local out = x;
      out.q.data()[k] += h;
      return out;
    };
    const double by =
        first_difference([&](double h) { return term->strain_energy(1, moved(h)); }, 1e-4);
    EXPECT_NEAR(force.data()[k], by, 1e-7 * largest);
    const VectorXd column = first_difference(
        [&](double h) {
          LocalRows f = LocalRows::Zero(x.q.rows(), 2);
          term->add_force(1, moved(h), f);
          return VectorXd(Eigen::Map<const VectorXd>(f.data(), f.size()));
        },
        1e-4);
    EXPECT_LT((tangent.col(k) - column).norm(), 1e-7 * tangent.norm());
  }
}

}  // namespace
}  // namespace flexmorph::fem
