#pragma once
#include "pdx/field/term.hpp"

namespace pdx::test {
/// A Term that does nothing: tests say only what theirs does.
class InertTerm : public field::Term {
public:
  void needed_rows(std::vector<PetscInt>&) const override {}
  void bind(const field::RowHalo&) override {}
  void add_residual(std::span<const double>, std::span<double>) const override {}
  double energy(std::span<const double>) const override { return 0.0; }
  void couplings(field::Couplings&, bool) const override {}
  void add_jacobian(field::BlockAdder&, bool) const override {}
  bool constant_jacobian() const override { return true; }
};
} // namespace pdx::test
