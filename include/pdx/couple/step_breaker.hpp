#pragma once
#include "pdx/couple/fracture.hpp"
#include "pdx/field/after_step.hpp"
#include "pdx/pd/cloud_term.hpp"

namespace pdx::couple {
/// What breaks bonds after each time step, in the plane or in space.
class BondBreaker : public field::AfterStep {
public:
  const pd::Broken& mine() const { return now_; } ///< since the start, what this rank counts
  void resume(const pd::Broken& mine) { now_ = saved_ = mine; }
  double dissipated() const override { return now_.energy; }

protected:
  pd::Broken now_, saved_;
};

/// Breaks bonds after each time step, between particles and those that leave their patch, at the displacement of the
/// last force: every overstretched bond at once. A pass of its own, entered only where that force saw one. Nothing
/// travels: ranks judge shared bonds by the same arithmetic.
template <int Dim> class StepBreaker final : public BondBreaker {
public:
  /// in_strips: the lattice bonds step explicitly from now on, and are looked at where their force saw one
  /// overstretched. as_terms: they stay as they are, and all are looked at after each step (collective then).
  enum class Steps { in_strips, as_terms };
  /// As for Fracture; `options.release` is not asked.
  StepBreaker(pd::BondTerm<Dim>& bonds, CarriedBonds<Dim>* carried, const FractureRule& options, Steps steps);

  void apply(std::span<const double> u, field::ForceLosses& losses) override;
  void save() override;
  void restore() override;

private:
  pd::BondTerm<Dim>& bonds_;
  CarriedBonds<Dim>* carried_;
  Steps steps_;
  std::vector<pd::BreakRule> rules_;
};

/// The same for the bonds of a cloud.
template <int Dim> class CloudBreaker final : public BondBreaker {
public:
  /// @param no_fail no bond with an end in one of these boxes breaks [m]
  CloudBreaker(pd::CloudTerm<Dim>& bonds, double critical_stretch, std::span<const geom::Box<2>> no_fail);

  void apply(std::span<const double> u, field::ForceLosses& losses) override;
  void save() override;
  void restore() override;

private:
  pd::CloudTerm<Dim>& bonds_;
};
} // namespace pdx::couple
