#pragma once

#include "fem/shapes/gram_gradient.h"
#include "fem/shapes/strain.h"
#include "fem/strain_term.h"
#include "fem/terms/eulerian_work.h"

/// Terms that are defined by energy densities or dissipation densities.
namespace flexmorph::fem {

/// Base class of all elastic terms. From the densities it computes the forces on free lines, the
/// powers of material flow, and a mean force that conserves the energy (GramGradient); derived
/// classes add closed forms.
class ElasticTerm : public StrainTerm,
                    public MeanForceTerm,
                    public EulerianLineTerm,
                    public DesignedTerm,
                    public ElasticEnergy,
                    public FlowTerm {
 public:
  std::string name() const override { return name_; }

  void add_eulerian_force(int e, const Local& x, EulerianForce& force) const override;
  void add_eulerian_tangent(int e, const Local& x, const Weights& w,
                            EulerianTangent& tangent) const override;
  void add_mean_force(int e, const LocalStep& x, LocalRows& force) const override;
  void add_mean_tangent(int e, const LocalStep& x, const Weights& w,
                        LocalTangent& tangent) const override;
  void add_scale_factor_gradient(int e, const Local& x, const LocalRows& psi,
                                 ScaleFactorGradient& out) const override;
  void add_energy_gradient(int e, const Local& x, double weight,
                           ScaleFactorGradient& out) const override;
  /// Returns the energy by energy_at(), or by EulerianElastic in elements with free lines.
  Energies energies(int e, const Local& x) const final;
  double flow_power(int e, const Local& x) const override;
  void add_line_energy(std::span<const ShapeTable> line, const Local& x,
                       LineEnergy& out) const override;

 protected:
  ElasticTerm(std::string name, std::vector<ElasticPart> parts)
      : name_(std::move(name)), parts_(std::move(parts)) {}

  /// Prepares the data of the functions above; prepare() of a derived class must call it.
  /// @throws Error (input) for free lines if a density does not support them.
  void prepare_parts(const Element& element, const ScaleFactors& factors);
  /// Returns the strain energy of an element without free lines [J].
  virtual double energy_at(int e, const Local& x) const = 0;

  /// Returns the densities and their sampling.
  const std::vector<ElasticPart>& parts() const { return parts_; }
  /// Returns the elements of the last prepare_parts().
  const Element& element() const { return *element_; }
  /// Returns the scale factors of the last prepare_parts().
  const ScaleFactors& factors() const { return *factors_; }
  /// Returns true if an element has free lines.
  bool is_free(int e) const { return !free_.empty() && free_.front().has(e); }

 private:
  std::string name_;
  std::vector<ElasticPart> parts_;
  std::vector<EulerianTables> free_;  // one per density
  GramGradient gradient_;
  const Element* element_ = nullptr;
  const ScaleFactors* factors_ = nullptr;
};

/// Tables of the strains of all elements, for the densities of a term.
class StrainTables {
 public:
  /// Tabulates the strains of all elements, or only of elements whose lines move if `all` is false.
  void prepare(const Element& element, const ScaleFactors& factors, bool all,
               std::span<const std::shared_ptr<const StrainSampling>> samplings);
  /// Returns the table of one density and element.
  const StrainTable& of(size_t part, int e) const { return tables_[part][static_cast<size_t>(e)]; }

 private:
  std::vector<std::vector<StrainTable>> tables_;  // by density and element
};

/// Returns a term that is the sum of elastic energies, U = Σ ∫ W(e) dA:
///
///   f = ∫ Bᵀ s dA,   s = ∂W/∂e,   K = ∫ Bᵀ ∂²W/∂e² B + Σ s_i ∂²e_i/∂q² dA,   B = ∂e/∂q
///
/// All functions of the interface follow from the densities. The closed forms of the other elastic
/// terms are tested against this term.
///
/// @throws Error (input) at prepare() for free lines if a density does not support them.
std::unique_ptr<StrainTerm> make_elastic_term(std::string name, std::vector<ElasticPart> parts);

/// Returns a term that dissipates energy,
///
///   f = ∫ Bᵀ s(e, ė) dA,   ė = B q̇ + ∂e/∂t,   power P = ∫ s · ė dA >= 0
///
/// The rates of the strains are those of the material: ∂e/∂t is their rate due to material flow at
/// constant unknowns. The mean force is the force of the mean state: it removes the energy h P of
/// this state, and it conserves momenta, because strains do not depend on rigid motions.
///
/// @throws Error (input) at prepare() for free material lines.
std::unique_ptr<StrainTerm> make_dissipative_term(std::string name,
                                                  std::vector<DissipativePart> parts);

}  // namespace flexmorph::fem
