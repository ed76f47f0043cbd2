#include "fem/thermal/heated.h"

#include <algorithm>
#include <cmath>

#include "geometry/text.h"

namespace flexmorph::fem {
namespace {

class Heated final : public StrainTerm,
                     public BatchTerm,
                     public MeanForceTerm,
                     public EulerianLineTerm,
                     public FlowTerm,
                     public DissipativeTerm,
                     public ScaledLoad,
                     public HeatedTerm {
 public:
  Heated(BodyTerm cold, const Heat& heat)
      : cold_(std::move(cold)), heat_(heat), power_(heat.volume_exponent()) {}

  std::unique_ptr<Term> clone() const override {
    auto out = std::make_unique<Heated>(cold_->clone(), heat_);
    out->factor_ = factor_;  // heat_to() sets the remaining members
    return out;
  }

  void prepare(const Element& element, const ScaleFactors& factors, bool all) override {
    element_ = &element;
    cold_->prepare(element, factors, all);
  }

  void heat_to(double t) override {
    rise_ = heat_.stretch(t);
    rise_.value -= 1;
    t_ = t;
    update();
  }
  void scale_load(double factor) override {
    factor_ = factor;
    update();
  }

  void add_force(int e, const Local& x, LocalRows& force) const override {
    LocalRows f = LocalRows::Zero(force.rows(), force.cols());
    cold_->add_force(e, shrunk(x), f);
    force += force_scale_ * f;
  }
  void add_tangent(int e, const Local& x, const Weights& w, LocalTangent& tangent) const override {
    cold_->add_tangent(e, shrunk(x), scaled(w), tangent);
  }

  void add_forces(const Batch& x, Pack* force) const override {
    Pack unknowns[kMaxLocal], rates[kMaxLocal], f[kMaxLocal];
    const int n = x.n_local();
    const Batch cold = shrunk(x, unknowns, rates);
    std::fill(f, f + n, Pack{});
    cold_.add_forces(cold, f);
    for (int k = 0; k < n; ++k) force[k] += force_scale_ * f[k];
  }
  void add_tangents(const Batch& x, const Weights& w, Pack* tangent) const override {
    Pack unknowns[kMaxLocal], rates[kMaxLocal];
    cold_.add_tangents(shrunk(x, unknowns, rates), scaled(w), tangent);
  }

  void add_mean_force(int e, const LocalStep& x, LocalRows& force) const override {
    LocalRows f = LocalRows::Zero(force.rows(), force.cols());
    cold_.with_mean_force().add_mean_force(e, shrunk(x), f);
    force += force_scale_ * f;
  }
  void add_mean_tangent(int e, const LocalStep& x, const Weights& w,
                        LocalTangent& tangent) const override {
    cold_.with_mean_force().add_mean_tangent(e, shrunk(x), scaled(w), tangent);
  }

  void add_eulerian_force(int e, const Local& x, EulerianForce& force) const override {
    EulerianForce f = EulerianForce::Zero(force.size());
    cold_.with_eulerian_lines().add_eulerian_force(e, shrunk(x), f);
    const Eigen::Index n = x.q.size();
    force.head(n) += force_scale_ * f.head(n);
    force.tail(force.size() - n) += energy_scale_ * f.tail(force.size() - n);
  }
  void add_eulerian_tangent(int e, const Local& x, const Weights& w,
                            EulerianTangent& tangent) const override {
    EulerianTangent k = EulerianTangent::Zero(tangent.rows(), tangent.cols());
    cold_.with_eulerian_lines().add_eulerian_tangent(e, shrunk(x), w, k);
    const Eigen::Index n = x.q.size(), m = tangent.rows() - n;
    tangent.topLeftCorner(n, n) += tangent_scale_ * k.topLeftCorner(n, n);
    tangent.topRightCorner(n, m) += force_scale_ * k.topRightCorner(n, m);
    tangent.bottomLeftCorner(m, n) += force_scale_ * k.bottomLeftCorner(m, n);
    tangent.bottomRightCorner(m, m) += energy_scale_ * k.bottomRightCorner(m, m);
  }

  Energies energies(int e, const Local& x) const override {
    return {.strain = energy_scale_ * cold_->strain_energy(e, shrunk(x))};
  }
  double dissipation(int e, const Local& x) const override {
    return cold_.dissipative ? energy_scale_ * cold_.dissipative->dissipation(e, shrunk(x)) : 0;
  }
  double flow_power(int e, const Local& x) const override {
    return cold_.flow ? energy_scale_ * cold_.flow->flow_power(e, shrunk(x)) : 0;
  }
  void add_line_energy(std::span<const ShapeTable> line, const Local& x,
                       LineEnergy& out) const override {
    if (!cold_.flow) return;
    LineEnergy cold;
    cold.set_zero(out.stiffness.size());
    cold_.flow->add_line_energy(line, shrunk(x), cold);
    out.stiffness += energy_scale_ * cold.stiffness;
    out.mass += energy_scale_ * cold.mass;
    out.none += energy_scale_ * cold.none;
  }

  double heat_power(int e, const Local& x) const override {
    if (rate_ == 0) return 0;
    return rate_ / s_ * (power_ * strain_energy(e, x) - work_of_growth(e, x));
  }

  std::string name() const override { return cold_->name(); }

 private:
  static constexpr int kMaxLocal = kMaxShapes * kMaxDim;

  void update() {
    s_ = 1 + factor_ * rise_.value;
    rate_ = factor_ * rise_.rate;
    if (!(s_ > 0) || !std::isfinite(s_) || !std::isfinite(rate_))
      throw Error::numerical(
          formatted("heat: 1 + alpha dT = %.6g at t = %.6g s; it must be positive", s_, t_));
    energy_scale_ = std::pow(s_, power_);
    force_scale_ = energy_scale_ / s_;
    tangent_scale_ = force_scale_ / s_;
  }

  /// Returns the weights of the cold term: derivatives of (x, ẋ) by the unknown, times the scale of
  /// the force derivatives.
  Weights scaled(const Weights& w) const {
    return {tangent_scale_ * w.q, tangent_scale_ * (w.v - rate_ / s_ * w.q), 0};
  }

  LocalRows shrunk(const LocalRows& q) const { return q * (1 / s_); }
  Local shrunk(const Local& x) const {
    Local out{shrunk(x.q), x.v, x.a};
    if (x.v.size() > 0) out.v = (x.v - rate_ / s_ * x.q) * (1 / s_);
    return out;
  }
  LocalStep shrunk(const LocalStep& x) const {
    return {shrunk(x.start), shrunk(x.end), shrunk(x.mean)};
  }
  /// Returns the batch of the cold body; its values are stored in `unknowns` and `rates` (kMaxLocal
  /// each).
  Batch shrunk(const Batch& x, Pack* unknowns, Pack* rates) const {
    const double scale = 1 / s_, growth = rate_ / s_;
    for (int k = 0; k < x.n_local(); ++k) {
      unknowns[k] = scale * x.q[k];
      rates[k] = scale * (x.v[k] - growth * x.q[k]);
    }
    Batch out = x;
    out.q = unknowns;
    out.v = rates;
    return out;
  }

  /// Returns F · q. Positions are relative to the first one, which does not change the work
  /// (translations cause no strain) and loses no digits far from the origin.
  double work_of_growth(int e, const Local& x) const {
    LocalRows force;
    if (element_->free_sides(e).empty()) {
      force.setZero(x.q.rows(), x.q.cols());
      add_force(e, x, force);
    } else {
      EulerianForce all = EulerianForce::Zero(x.q.size() + 4);
      add_eulerian_force(e, x, all);
      force = Eigen::Map<const LocalRows>(all.data(), x.q.rows(), x.q.cols());
    }
    const auto vectors = element_->vectors(e);
    const Eigen::Index dim = x.q.cols();
    const double* first = nullptr;
    double out = 0;
    for (Eigen::Index k = 0; k < x.q.rows(); ++k) {
      const double *q = x.q.data() + dim * k, *f = force.data() + dim * k;
      const bool position = element_->is_position(vectors[static_cast<size_t>(k)]);
      if (position && !first) first = q;
      for (Eigen::Index c = 0; c < dim; ++c) out += f[c] * (q[c] - (position ? first[c] : 0.0));
    }
    return out;
  }

  BodyTerm cold_;
  Heat heat_;
  int power_;
  const Element* element_ = nullptr;  // from the last prepare()
  Motion rise_;                       // α ΔT at t_
  double t_ = 0, factor_ = 1;
  double s_ = 1, rate_ = 0;                                        // s, ṡ
  double energy_scale_ = 1, force_scale_ = 1, tangent_scale_ = 1;  // sᵖ, sᵖ⁻¹, sᵖ⁻²
};

}  // namespace

std::unique_ptr<Term> make_heated(BodyTerm cold, const Heat& heat) {
  if (!cold.strain)
    throw Error::input("heat acts on elastic terms, but the term '" + cold->name() +
                       "' is not elastic");
  if (!heat.temperature) throw Error::input("heat: the temperature is missing");
  if (!std::isfinite(heat.expansion))
    throw Error::input(
        formatted("heat: the coefficient of thermal expansion is %g 1/K; it is a finite number",
                  heat.expansion));
  return std::make_unique<Heated>(std::move(cold), heat);
}

void heat(Body& body, const Heat& heat) {
  const std::string who = "body '" + body.name + "': ";
  if (body.element->is_rigid()) throw Error::input(who + "a rigid body cannot be heated");
  if (body.heat) throw Error::input(who + "it is heated already");
  const auto is_strained = [](const BodyTerm& t) { return t.strain != nullptr; };
  if (std::none_of(body.terms.begin(), body.terms.end(), is_strained))
    throw Error::input(who + "it has no elastic term on which heat can act");
  for (BodyTerm& term : body.terms)
    if (is_strained(term)) term = make_heated(std::move(term), heat);
  body.heat = heat;
}

}  // namespace flexmorph::fem
