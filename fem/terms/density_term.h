#pragma once

#include "fem/shapes/gram_gradient.h"
#include "fem/shapes/strain.h"
#include "fem/strain_term.h"
#include "fem/terms/free_work.h"

/// Terms made of densities.
namespace flexmorph::fem {

/// What every elastic term has from its densities, whatever closed forms it brings: forces on free
/// lines, powers of material flow, and a mean force that keeps the energy (GramGradient).
class ElasticTerm : public StrainTerm,
                    public MeanForceTerm,
                    public FreeLineTerm,
                    public DesignedTerm,
                    public ElasticEnergy,
                    public FlowTerm {
 public:
  std::string name() const override { return name_; }

  void add_free_force(int e, const Local& x, FreeForce& force) const override;
  void add_free_tangent(int e, const Local& x, const Weights& w,
                        FreeTangent& tangent) const override;
  void add_mean_force(int e, const LocalStep& x, LocalRows& force) const override;
  void add_mean_tangent(int e, const LocalStep& x, const Weights& w,
                        LocalTangent& tangent) const override;
  void add_factor_slopes(int e, const Local& x, const LocalRows& psi,
                         FactorSlopes& out) const override;
  void add_energy_slopes(int e, const Local& x, double weight, FactorSlopes& out) const override;
  /// energy_at(), or that of FreeElastic next to free lines.
  Energies energies(int e, const Local& x) const final;
  double flow_power(int e, const Local& x) const override;
  void add_line_energy(std::span<const ShapeTable> line, const Local& x,
                       LineEnergy& out) const override;

 protected:
  ElasticTerm(std::string name, std::vector<ElasticPart> parts)
      : name_(std::move(name)), parts_(std::move(parts)) {}

  /// To be called by prepare(): what the functions above need.
  /// @throws Error (input) for free lines and a density that does not know them.
  void prepare_parts(const Element& element, const Factors& factors);
  /// Strain energy of an element without free lines [J].
  virtual double energy_at(int e, const Local& x) const = 0;

  const std::vector<ElasticPart>& parts() const { return parts_; }
  const Element& element() const { return *element_; }  ///< of the last prepare_parts()
  const Factors& factors() const { return *factors_; }
  bool is_free(int e) const { return !free_.empty() && free_.front().has(e); }

 private:
  std::string name_;
  std::vector<ElasticPart> parts_;
  std::vector<FreeTables> free_;  // of every part
  GramGradient gradient_;
  const Element* element_ = nullptr;
  const Factors* factors_ = nullptr;
};

/// Tables of the strains of all elements, for the parts of a term.
class StrainTables {
 public:
  void prepare(const Element& element, const Factors& factors, bool all,
               std::span<const std::shared_ptr<const StrainSampling>> samplings);
  const StrainTable& of(size_t part, int e) const { return tables_[part][static_cast<size_t>(e)]; }

 private:
  std::vector<std::vector<StrainTable>> tables_;  // of part, element
};

/// A term that is the sum of elastic energies, U = Σ ∫ W(e) dA:
///
///   f = ∫ Bᵀ s dA,   s = ∂W/∂e,   K = ∫ Bᵀ ∂²W/∂e² B + Σ s_i ∂²e_i/∂q² dA,   B = ∂e/∂q
///
/// Everything that the seam asks of it follows from the densities. Closed forms of the other
/// elastic terms are tested against it.
///
/// @throws Error (input) at prepare() for free lines and a density that does not know them.
std::unique_ptr<StrainTerm> make_elastic_term(std::string name, std::vector<ElasticPart> parts);

/// A term that dissipates,
///
///   f = ∫ Bᵀ s(e, ė) dA,   ė = B q̇ + ∂e/∂t,   power P = ∫ s · ė dA >= 0
///
/// rates of strains being those of the material: ∂e/∂t is what material flow makes of them where
/// the unknowns stand still. Its mean force is that of the mean state: it takes h P there out of
/// the energy, and leaves momenta as they are, because strains do not see rigid motions.
///
/// @throws Error (input) at prepare() for free material lines.
std::unique_ptr<StrainTerm> make_dissipative_term(std::string name,
                                                  std::vector<DissipativePart> parts);

}  // namespace flexmorph::fem
