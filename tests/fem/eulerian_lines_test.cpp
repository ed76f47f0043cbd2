// Shows that forces on free material lines and their tangents are right: elastic forces are the
// gradient of the energy, the inertia of an inner line satisfies Lagrange's equation, an element
// with prescribed lines has equal forces, and every Jacobian (q, v, a) agrees with differences,
// including the derivatives of the limits of integration.
#include <gtest/gtest.h>

#include "fem/loads.h"
#include "fem/model/workspace.h"
#include "fem/terms.h"
#include "fem/terms/densities.h"
#include "tests/support/differences.h"
#include "tests/support/models.h"
#include "tests/support/sections.h"

namespace flexmorph::fem {
namespace {

using testing::first_difference;
using testing::ShapeSet;

/// One element (or two along m) of which all lines are free, and a motion of all its unknowns.
struct FreePlate {
  AncfPlate plate;
  testing::SmoothMotion motion;  // unknowns of vectors, then of lines

  static std::vector<MaterialLine> lines(const std::vector<double>& at) {
    std::vector<MaterialLine> out;
    for (const double x : at) out.push_back({x, {}, true});
    return out;
  }
  static VectorXd mean(const AncfPlate& p) {
    const VectorRows rest = testing::random_shape(p, 0.2, 5);
    VectorXd out(rest.size() + p.n_scalars());
    out.head(rest.size()) = Eigen::Map<const VectorXd>(rest.data(), rest.size());
    int k = 0;
    for (const auto& line : p.lines_m()) out[rest.size() + k++] = line.value;
    while (k < p.n_scalars()) {
      out[rest.size() + k] = p.line_n(k - static_cast<int>(p.lines_m().size())).value;
      ++k;
    }
    return out;
  }
  FreePlate(int dim, ShapeSet shapes, const std::vector<double>& m)
      : plate(dim, shapes, lines(m), lines({-0.02, 0.05})),
        motion(mean(plate), VectorXd::Constant(mean(plate).size(), 0.004), 3) {}

  Eigen::Index n_rows() const { return plate.n_vectors(); }
  Eigen::Index n() const { return n_rows() * plate.dim() + plate.n_scalars(); }

  /// Moves the lines and returns the unknowns of element e.
  Local local(int e, const VectorXd& q, const VectorXd& v, const VectorXd& a) {
    const auto tail = [&](const VectorXd& x) { return VectorXd(x.tail(plate.n_scalars())); };
    plate.move_lines(tail(q), tail(v), tail(a));
    const auto rows = [&](const VectorXd& x) {
      return testing::rows_of_element(
          plate, Eigen::Map<const VectorRows>(x.data(), n_rows(), plate.dim()), e);
    };
    return {rows(q), rows(v), rows(a)};
  }
  EulerianTable table(int e, int degree, Tabulate what) const {
    EulerianTable out;
    plate.tabulate_eulerian(e, degree, what, out);
    return out;
  }
  /// Returns the indices of the unknowns of element e among all unknowns.
  std::vector<Eigen::Index> locations(int e) const {
    std::vector<Eigen::Index> out;
    for (const int k : plate.vectors(e))
      for (int c = 0; c < plate.dim(); ++c) out.push_back(plate.dim() * k + c);
    for (const int s : plate.free_sides(e)) out.push_back(n_rows() * plate.dim() + s);
    return out;
  }
};

struct LineMotion {
  int dim;
  ShapeSet shapes;
};
void PrintTo(const LineMotion& c, std::ostream* out) {
  *out << c.dim << (c.shapes == ShapeSet::h12 ? "d_h12" : "d_h16");
}
class EulerianLines : public ::testing::TestWithParam<LineMotion> {};
INSTANTIATE_TEST_SUITE_P(All, EulerianLines,
                         ::testing::Values(LineMotion{2, ShapeSet::h12},
                                           LineMotion{2, ShapeSet::h16},
                                           LineMotion{3, ShapeSet::h12},
                                           LineMotion{3, ShapeSet::h16}));

/// Returns the largest row sum of the difference relative to the one of the expected matrix.
double relative(const MatrixXd& is, const MatrixXd& should) {
  return (is - should).lpNorm<Eigen::Infinity>() / should.lpNorm<Eigen::Infinity>();
}

TEST_P(EulerianLines, ElasticForcesAreTheGradientOfTheEnergy) {
  FreePlate x(GetParam().dim, GetParam().shapes, {0.1, 0.18});
  const MembraneDensity density(kThinSection);
  const VectorXd q = x.motion.q(0.3), zero = VectorXd::Zero(x.n());
  const auto locations = x.locations(0);
  const auto energy = [&](const VectorXd& at) {
    const Local local = x.local(0, at, zero, zero);
    const EulerianTable t = x.table(0, 12, Tabulate::gradient);
    return EulerianElastic(density, t).energy(local.q);
  };
  const auto force = [&](const VectorXd& at) {
    const Local local = x.local(0, at, zero, zero);
    const EulerianTable t = x.table(0, 12, Tabulate::gradient);
    EulerianForce out = EulerianForce::Zero(static_cast<Eigen::Index>(locations.size()));
    EulerianElastic(density, t).add_force(local.q, out);
    return VectorXd(out);
  };
  VectorXd gradient(static_cast<Eigen::Index>(locations.size()));
  MatrixXd tangent(locations.size(), locations.size());
  for (size_t k = 0; k < locations.size(); ++k) {
    const auto moved = [&](double h) {
      return VectorXd(q + h * VectorXd::Unit(x.n(), locations[k]));
    };
    const auto i = static_cast<Eigen::Index>(k);
    gradient[i] = first_difference([&](double h) { return energy(moved(h)); }, 1e-5);
    tangent.col(i) = first_difference([&](double h) { return force(moved(h)); }, 1e-5);
  }
  EXPECT_LT(relative(force(q), gradient), 1e-8);
  const Local local = x.local(0, q, zero, zero);
  const EulerianTable t = x.table(0, 12, Tabulate::gradient);
  EulerianTangent exact = EulerianTangent::Zero(tangent.rows(), tangent.cols());
  EulerianElastic(density, t).add_tangent(local.q, 1, exact);
  EXPECT_LT(relative(exact, tangent), 1e-7);
  const auto lines = Eigen::lastN(4);
  EXPECT_LT(relative(exact(Eigen::all, lines), tangent(Eigen::all, lines)), 1e-7);
}

TEST_P(EulerianLines, JacobiansOfInertiaAreExact) {
  FreePlate x(GetParam().dim, GetParam().shapes, {0.1, 0.18});
  const VectorXd gravity = VectorXd::Constant(GetParam().dim, 3.0);
  const EulerianInertia inertia(27, gravity, true);
  const double time = 0.3;
  const VectorXd q = x.motion.q(time), v = x.motion.v(time), a = x.motion.a(time);
  const auto locations = x.locations(0);
  const auto n = static_cast<Eigen::Index>(locations.size());
  const Weights w{0.7, 130, 9e3};
  const auto force = [&](const VectorXd& step) {
    const Local local = x.local(0, q + w.q * step, v + w.v * step, a + w.a * step);
    EulerianForce out = EulerianForce::Zero(n);
    inertia.add_force(x.table(0, 6, Tabulate::position), local, out);
    return VectorXd(out);
  };
  MatrixXd tangent(n, n);
  for (Eigen::Index k = 0; k < n; ++k)
    tangent.col(k) = first_difference(
        [&](double h) {
          return force(h * VectorXd::Unit(x.n(), locations[static_cast<size_t>(k)]));
        },
        1e-4);
  const Local local = x.local(0, q, v, a);
  EulerianTangent exact = EulerianTangent::Zero(n, n);
  inertia.add_tangent(x.table(0, 6, Tabulate::position), local, w, exact);
  for (Eigen::Index k = 0; k < n; ++k) EXPECT_LT(relative(exact.col(k), tangent.col(k)), 1e-7) << k;
}

// The forces on the vector unknowns must equal those of the element whose lines have the same
// prescribed motion.
TEST_P(EulerianLines, PrescribedLinesAreTheSameElement) {
  const int dim = GetParam().dim;
  FreePlate x(dim, GetParam().shapes, {0.1, 0.18});
  const auto drive = [&](int line) {
    const Eigen::Index at = x.n_rows() * dim + line;
    return MaterialLine{0, [&x, at](double t) {
                          return Motion{x.motion.q(t)[at], x.motion.v(t)[at], x.motion.a(t)[at]};
                        }};
  };
  const double time = 0.4;
  AncfPlate prescribed(dim, GetParam().shapes, {drive(0), drive(1)}, {drive(2), drive(3)}, time);
  const auto term = make_inertia(kThinSection);
  const ScaleFactors full;
  term->prepare(prescribed, full, true);
  const Local local = x.local(0, x.motion.q(time), x.motion.v(time), x.motion.a(time));
  LocalRows rows = LocalRows::Zero(local.q.rows(), dim);
  term->add_force(0, local, rows);
  const VectorXd none;
  EulerianForce force = EulerianForce::Zero(rows.size() + 4);
  const EulerianInertia inertia(27, none, true);
  const EulerianTable t = x.table(0, 6, Tabulate::position);
  inertia.add_force(t, local, force);
  EXPECT_LT(relative(force.head(rows.size()), Eigen::Map<const VectorXd>(rows.data(), rows.size())),
            1e-12);
  EXPECT_NEAR(inertia.kinetic_energy(t, local) / term->kinetic_energy(0, local), 1, 1e-12);
}

// Two elements have one line between them. The inertia force on this line from the virtual work at
// fixed material points must equal d/dt ∂T/∂ṗ - ∂T/∂p of both elements together, although each
// integral has moving limits.
TEST_P(EulerianLines, InertiaOfAnInnerLineIsLagranges) {
  FreePlate x(GetParam().dim, GetParam().shapes, {0.1, 0.18, 0.25});
  const VectorXd none;
  const EulerianInertia inertia(27, none, true);
  const Eigen::Index line = x.n_rows() * x.plate.dim() + 1;
  // The outer lines are fixed.
  const auto rest = [&](VectorXd y, bool value) {
    for (const int k : {0, 2, 3, 4}) {
      const Eigen::Index at = x.n_rows() * x.plate.dim() + k;
      y[at] = value ? x.motion.q(0)[at] : 0;
    }
    return y;
  };
  const auto kinetic = [&](const VectorXd& q, const VectorXd& v) {
    double out = 0;
    for (int e = 0; e < 2; ++e) {
      const Local local = x.local(e, q, v, VectorXd::Zero(x.n()));
      out += inertia.kinetic_energy(x.table(e, 6, Tabulate::position), local);
    }
    return out;
  };
  const VectorXd unit = VectorXd::Unit(x.n(), line);
  const auto q_at = [&](double t) { return rest(x.motion.q(t), true); };
  const auto v_at = [&](double t) { return rest(x.motion.v(t), false); };
  const double time = 0.4;
  const auto momentum = [&](double t) {
    return first_difference([&](double h) { return kinetic(q_at(t), v_at(t) + h * unit); }, 1e-2);
  };
  const double lagrange =
      first_difference([&](double h) { return momentum(time + h); }, 1e-3) -
      first_difference([&](double h) { return kinetic(q_at(time) + h * unit, v_at(time)); }, 1e-4);
  double force = 0, size = 0;
  for (int e = 0; e < 2; ++e) {
    const Local local = x.local(e, q_at(time), v_at(time), rest(x.motion.a(time), false));
    EulerianForce out = EulerianForce::Zero(local.q.size() + 4);
    inertia.add_force(x.table(e, 6, Tabulate::position), local, out);
    const double own = out[local.q.size() + (e == 0 ? kM2 : kM1)];
    force += own;
    size += std::abs(own);
  }
  EXPECT_NEAR(force, lagrange, 1e-6 * size);
}

// Tests the whole iteration matrix of a model in space with bending, weight and a free line in its
// middle.
TEST(EulerianLinesOfAModel, TangentIsExact) {
  for (const ShapeSet shapes : {ShapeSet::h12, ShapeSet::h16}) {
    auto lines = testing::uniform_lines(0, 0.4, 4);
    lines[2].free = true;
    std::vector<std::unique_ptr<Term>> terms;
    for (const char* name : {"membrane", "bending", "inertia"})
      terms.push_back(make_term(name, kThinSection));
    terms.push_back(make_gravity(kThinSection, VectorXd::Constant(3, 2.0)));
    Workspace model;
    model.add_body("plate",
                   std::make_unique<AncfPlate>(3, shapes, lines, testing::uniform_lines(0, 0.1, 1)),
                   kThinSection, std::move(terms));
    const State rest = model.reference();
    const auto n = rest.q.size();
    const testing::SmoothMotion motion(rest.q, 0.02 * model.scales().cwiseInverse(), 7);
    const Weights w{1, 90, 8e3};
    const auto moved = [&](const VectorXd& step) {
      State x = motion.state(0.2);
      x.q += w.q * step;
      x.v += w.v * step;
      x.a += w.a * step;
      model.prepare(x);
      return x;
    };
    const auto force = [&](const VectorXd& step) {
      VectorXd out;
      model.force(moved(step), out);
      return out;
    };
    MatrixXd tangent(n, n);
    for (Eigen::Index k = 0; k < n; ++k)
      tangent.col(k) =
          first_difference([&](double h) { return force(h * VectorXd::Unit(n, k)); }, 1e-4);
    Constraints none;
    SparseMatrix exact;
    const State x = moved(VectorXd::Zero(n));
    model.constraints(x, none);
    model.kkt(x, none, w, 1, exact);
    // Each column is compared separately, because columns differ by orders of magnitude.
    for (Eigen::Index k = 0; k < n; ++k)
      EXPECT_LT(relative(MatrixXd(exact).col(k), tangent.col(k)), 1e-7) << k;
  }
}

}  // namespace
}  // namespace flexmorph::fem
