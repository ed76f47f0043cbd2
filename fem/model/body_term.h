#pragma once

#include <memory>

#include "fem/load_term.h"
#include "fem/strain_term.h"
#include "fem/term.h"

namespace flexmorph::fem {

/// A term of a body with the interfaces that its class has, which are looked up once, when the term
/// is added.
struct BodyTerm {
  /// Creates the entry of a term; the conversion is implicit, so that a list of terms accepts
  /// terms.
  BodyTerm(std::unique_ptr<Term> term = nullptr);
  /// Creates the entry of a term made of strains.
  BodyTerm(std::unique_ptr<StrainTerm> term) : BodyTerm(std::unique_ptr<Term>(std::move(term))) {}

  /// Returns a pointer to the term itself.
  Term* operator->() const { return term.get(); }
  /// Returns a reference to the term itself.
  Term& operator*() const { return *term; }

  /// Adds the forces of eight elements, one by one where the term is no BatchTerm.
  void add_forces(const Batch& x, Pack* force) const;
  /// Adds the tangent matrices of eight elements, one by one where the term is no BatchTerm.
  void add_tangents(const Batch& x, const Weights& w, Pack* tangent) const;
  /// Returns the interface for free lines.
  /// @throws Error (input) where the term has none
  const EulerianLineTerm& with_eulerian_lines() const;
  /// Returns the interface for a mean force.
  /// @throws Error (input) where the term has none
  const MeanForceTerm& with_mean_force() const;

  std::unique_ptr<Term> term;  ///< The term itself.
  // Interfaces of the term, null where its class lacks the interface.
  const BatchTerm* batch;                  ///< Evaluation of eight elements at once.
  const MeanForceTerm* mean;               ///< Mean force of a step.
  const EulerianLineTerm* eulerian_lines;  ///< Forces on free lines.
  const DesignedTerm* designed;            ///< Derivatives by the scale factors.
  const ElasticEnergy* elastic;            ///< Derivatives of the strain energy.
  const FlowTerm* flow;                    ///< Power of material flow.
  const DissipativeTerm* dissipative;      ///< Dissipated power.
  ScaledLoad* scaled;                      ///< Load factor.
  LoadTerm* load;                          ///< The term as a load.
  StrainTerm* strain;                      ///< The term as a term made of strains.
  HeatedTerm* heated;                      ///< The term as a term with a temperature.
};

}  // namespace flexmorph::fem
