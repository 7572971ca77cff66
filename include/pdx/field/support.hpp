#pragma once
#include "pdx/field/term.hpp"

namespace pdx::field {
/// An owned row that is kept from moving along a direction (a unit vector).
struct Resisting {
  Index row;
  Vector<3> along;
};

/// What pushes rows from outside by a stiffness of its own: springs to the ground, a pin. Its energy is its own.
class Support : public Term {
public:
  void needed_rows(std::vector<PetscInt>&) const override {}
  void bind(const RowHalo&) override {}
  /// The next forces are those of a time; before the first call, of 0 [s].
  virtual void go_to_time(double time) { (void)time; }
  /// In statics: of a load factor.
  virtual void go_to_load(double load) { (void)load; }
  /// What it resists in the state of the last tangent; before the first, at rest.
  virtual void resisting(std::vector<Resisting>& found) const = 0;
  /// What moves by itself as time goes does work: `note` keeps the state between two steps, `work_since` is this rank's
  /// part of what was done from there to a later one [J].
  ///@{
  virtual void note(std::span<const double> u) { (void)u; }
  virtual double work_since(std::span<const double> u) const
  {
    (void)u;
    return 0.0;
  }
  ///@}
  /// Force on the body of what this rank counts, in all [N].
  virtual Vector<3> push(std::span<const double> u) const = 0;
};

/// Linear springs from owned rows to the ground: force -K_i u_i on row i.
class SpringTerm final : public Support {
public:
  /// @param rows owned, local, each once   @param stiffness dim x dim of each, symmetric, no eigenvalue below 0 [N/m]
  SpringTerm(int dim, std::vector<Index> rows, std::vector<double> stiffness)
      : dim_(dim), rows_(std::move(rows)), stiffness_(std::move(stiffness))
  {}

  void resisting(std::vector<Resisting>& found) const override;
  Vector<3> push(std::span<const double> u) const override;
  void add_residual(std::span<const double> u, std::span<double> r) const override;
  double energy(std::span<const double> u) const override;
  void couplings(Couplings& couplings, bool whole) const override { (void)couplings, (void)whole; }
  void add_jacobian(BlockAdder& adder, bool whole) const override;
  bool constant_jacobian() const override { return true; }
  bool fixed() const override { return true; }
  void add_stiffness_bound(std::span<double> blocks) const override;

private:
  template <class Visit> void for_each_force(std::span<const double> u, Visit&& visit) const;

  int dim_;
  std::vector<Index> rows_;
  std::vector<double> stiffness_;
};
} // namespace pdx::field
