#include "pdx/solve/condensed_system.hpp"

#include "pdx/base/events.hpp"
#include "pdx/base/gather.hpp"
#include "pdx/solve/condensed_coarse.hpp"
#include "pdx/solve/dense_product.hpp"

#include <algorithm>

namespace pdx::solve {
namespace {
/// All fixed Terms: force S u on the kept rows. Blocks on the diagonal go into the sparse part, for smoothers.
class CondensedTerm final : public field::Term {
public:
  CondensedTerm(const KeptRows& kept, const Condensation& condensation)
      : comm_(kept.rows().comm), condensation_(condensation), off_diagonal_(condensation.stiffness()),
        dim_(kept.rows().dim)
  {
    MPI_Comm_size(comm_, &ranks_);
    for (Eigen::Index row = 0; row < off_diagonal_.rows(); row += dim_)
      off_diagonal_.block(row, row + condensation.first(), dim_, dim_).setZero();
  }
  void needed_rows(std::vector<PetscInt>&) const override {}
  void bind(const field::RowHalo&) override {}
  void add_residual(std::span<const double> u, std::span<double> r) const override
  {
    add(condensation_.stiffness(), u, r);
  }
  double energy(std::span<const double> u) const override
  {
    std::vector<double> force(static_cast<std::size_t>(off_diagonal_.rows()), 0.0);
    add_residual(u, force);
    double twice = 0.0;
    for (std::size_t k = 0; k < force.size(); ++k) twice += force[k] * u[k];
    return 0.5 * twice;
  }
  void couplings(field::Couplings&, bool) const override {}
  void add_jacobian(field::BlockAdder& adder, bool) const override
  {
    std::vector<double> block(static_cast<std::size_t>(dim_ * dim_));
    for (Index row = 0; row < static_cast<Index>(off_diagonal_.rows()) / dim_; ++row) {
      Eigen::Map<Condensation::Matrix>(block.data(), dim_, dim_) =
          condensation_.stiffness().block(row * dim_, row * dim_ + condensation_.first(), dim_, dim_);
      adder.add({&row, 1}, {&row, 1}, block);
    }
  }
  void add_tangent_action(std::span<const double> x, std::span<double> y) const override
  {
    static Event event("solve_condensed");
    const Timed timed(event);
    add(off_diagonal_, x, y);
  }
  bool constant_jacobian() const override { return true; }

private:
  /// Kept components are the first of a rank's own.
  void add(const Condensation::Matrix& matrix, std::span<const double> x, std::span<double> y) const
  {
    const auto rows = static_cast<std::size_t>(matrix.rows()), columns = static_cast<std::size_t>(matrix.cols());
    if (ranks_ == 1) return add_dense_product(matrix.data(), rows, columns, x.data(), y.data());
    const std::vector<double> all = gather_all(comm_, std::vector<double>(x.begin(), x.begin() + matrix.rows()));
    add_dense_product(matrix.data(), rows, columns, all.data(), y.data());
  }

  MPI_Comm comm_;
  int ranks_ = 1;
  const Condensation& condensation_;
  Condensation::Matrix off_diagonal_;
  int dim_;
};

/// A Term of the whole System on the kept rows. The first of them acts for all: whole vectors are filled once.
class KeptTerm final : public field::Term {
public:
  KeptTerm(KeptRows& kept, field::Term& term, std::vector<const field::Term*> acting)
      : kept_(kept), term_(term), acting_(std::move(acting))
  {}
  void needed_rows(std::vector<PetscInt>& rows) const override
  {
    if (!acting_.empty()) rows = kept_.needed();
  }
  void bind(const field::RowHalo& halo) override
  {
    if (!acting_.empty()) kept_.bind(halo);
    const auto size = static_cast<std::size_t>(kept_.whole().rows.owned() * kept_.rows().dim);
    x_.assign(size, 0.0);
    y_.assign(size, 0.0);
  }
  void add_residual(std::span<const double> u, std::span<double> r) const override
  {
    kept_.widen(r, y_);
    term_.add_residual(kept_.widened(u), y_);
    kept_.narrow(y_, r);
  }
  double energy(std::span<const double> u) const override { return term_.energy(kept_.widened(u)); }
  void linearise(std::span<const double> u) override { term_.linearise(kept_.widened(u)); }
  void couplings(field::Couplings& couplings, bool whole) const override
  {
    field::Couplings found(*kept_.whole().halo);
    term_.couplings(found, whole);
    for (Index row = 0; row < kept_.rows().owned(); ++row) {
      const auto to = static_cast<std::size_t>(row), from = static_cast<std::size_t>(kept_.whole_row(row));
      couplings.diagonal[to] += found.diagonal[from] - 1;
      couplings.off_diagonal[to] += found.off_diagonal[from];
    }
  }
  void add_jacobian(field::BlockAdder& adder, bool whole) const override
  {
    field::BlockAdder renumbered(adder.matrix(), *kept_.whole().halo, kept_.whole().held, kept_.renumbered());
    term_.add_jacobian(renumbered, whole);
  }
  void add_tangent_action(std::span<const double> x, std::span<double> y) const override
  {
    if (acting_.empty()) return;
    kept_.widen(x, x_);
    kept_.widen(y, y_);
    for (const field::Term* term : acting_) term->add_tangent_action(x_, y_);
    kept_.narrow(y_, y);
  }
  void weak_rows(std::vector<Index>& rows) const override
  {
    std::vector<Index> whole;
    term_.weak_rows(whole);
    for (const Index row : whole)
      if (const Index kept = kept_.kept_row(row); kept >= 0) rows.push_back(kept);
  }
  bool constant_jacobian() const override { return term_.constant_jacobian(); }
  std::int64_t revision() const override { return term_.revision(); }
  bool symmetric() const override { return term_.symmetric(); }

private:
  KeptRows& kept_;
  field::Term& term_;
  std::vector<const field::Term*> acting_;
  mutable std::vector<double> x_, y_; // owned values of the whole System
};

/// All that the whole System asks after a solve.
class KeptAfter final : public field::AfterSolve {
public:
  explicit KeptAfter(const KeptRows& kept) : kept_(kept) {}
  std::int64_t apply(std::span<const double> u) override
  {
    const std::span<const double> whole = kept_.widened(u);
    std::int64_t changes = 0;
    for (const auto& after : kept_.whole().after) changes += after->apply(whole);
    return changes;
  }
  void save() override
  {
    for (const auto& after : kept_.whole().after) after->save();
  }
  void restore() override
  {
    for (const auto& after : kept_.whole().after) after->restore();
  }

private:
  const KeptRows& kept_;
};
} // namespace

CondensedSystem::CondensedSystem(const field::System& whole, const Condensation& condensation)
    : condensation_(condensation), kept_(whole, condensation.border().kept)
{
  system_.rows = kept_.rows();
  system_.scale = whole.scale;
  system_.terms.push_back(std::make_unique<CondensedTerm>(kept_, condensation));
  std::vector<const field::Term*> acting;
  for (const auto& term : whole.terms)
    if (!term->fixed()) acting.push_back(term.get());
  for (const auto& term : whole.terms)
    if (!term->fixed()) system_.terms.push_back(std::make_unique<KeptTerm>(kept_, *term, std::exchange(acting, {})));
  if (!whole.after.empty()) system_.after.push_back(std::make_unique<KeptAfter>(kept_));
  add_prescribed();
  system_.load = narrowed(whole.load);
  std::ranges::copy(condensation.load(), system_.load.begin());
  system_.coordinates = narrowed(whole.coordinates);
  system_.bind();
  system_.coarse = std::make_unique<CondensedCoarse>(kept_, condensation);
}

void CondensedSystem::add_prescribed()
{
  const auto& [components, values] = kept_.whole().prescribed;
  const Index dim = kept_.rows().dim;
  for (std::size_t k = 0; k < components.size(); ++k) {
    const Index row = kept_.kept_row(components[k] / dim);
    if (row < 0) continue;
    system_.prescribed.components.push_back(row * dim + components[k] % dim);
    system_.prescribed.values.push_back(values[k]);
  }
}

std::vector<double> CondensedSystem::narrowed(std::span<const double> whole) const
{
  std::vector<double> owned(static_cast<std::size_t>(kept_.rows().owned() * kept_.rows().dim));
  kept_.narrow(whole, owned);
  return owned;
}

void CondensedSystem::narrow(Vec whole, Vec condensed) const
{
  field::set_owned_values(condensed, narrowed(field::owned_values(whole)));
}

void CondensedSystem::recover(Vec condensed, double load, Vec whole) const
{
  std::vector<double> u(static_cast<std::size_t>(kept_.whole().rows.owned() * kept_.rows().dim));
  kept_.widen(field::owned_values(condensed), u);
  condensation_.recover(load, u);
  field::set_owned_values(whole, u);
}
} // namespace pdx::solve
