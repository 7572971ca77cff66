#pragma once
#include "pdx/field/row_name.hpp"
#include "pdx/solve/inner_factor.hpp"
#include "pdx/solve/matrix_rows.hpp"

#include <memory>

namespace pdx::solve {
/// A node or an enriched set by its number in a System.
struct NamedRow {
  field::RowName name;
  PetscInt row = 0;
};
/// The elements of a layout as one rank sees them all. Components are those of the whole System.
struct ElementsOfLayout {
  const MatrixRows& stiffness; ///< of the fixed Terms
  PetscInt dim = 2;
  std::vector<NamedRow> rows;       ///< by name; empty where no other layout is to come
  std::vector<PetscInt> free, kept; ///< each ascending; the others are prescribed
};

/// Elements far from all that changes, eliminated once for several layouts: K_QQ is factored, and what is left at the
/// components B around is kept. [static-solver.md]
class LastingCore {
public:
  /// @param changed components that were not as in the layout before: what comes next is expected around them, and
  ///                stays out
  LastingCore(const ElementsOfLayout& in, std::span<const PetscInt> changed);
  const std::string& fault() const { return fault_; } ///< "" or why there is none

  /// Goes over to another layout, if nothing of the core has changed there.
  /// @return components that did change, as that layout numbers them; nothing if the core stands there
  struct Change {
    bool stands = false;
    std::vector<PetscInt> changed;
  };
  Change go_to(const ElementsOfLayout& next);

  /// Components as the present layout numbers them: eliminated, around.
  ///@{
  const std::vector<PetscInt>& inner() const { return inner_; }
  const std::vector<PetscInt>& border() const { return border_; }
  ///@}
  /// -K_BQ K_QQ^-1 K_QB, row by row.
  const std::vector<double>& correction() const { return correction_; }
  void forget_correction() { correction_ = {}; }
  /// K_QQ^-1 f; the last answer is kept. [m]
  const std::vector<double>& loaded(const std::vector<double>& force);
  /// -K_QQ^-1 K_QB u
  std::vector<double> answer(std::span<const double> u) const
  {
    return factor_ ? factor_->answer(u) : std::vector<double>{};
  }
  /// f - K_BQ u
  std::vector<double> condensed(std::vector<double> f, std::span<const double> u) const
  {
    if (!factor_) return f;
    return factor_->condensed(std::move(f), u);
  }

private:
  void choose(const MatrixRows& k, const ElementsOfLayout& in, std::span<const PetscInt> changed);
  void remember(const MatrixRows& k);

  PetscInt dim_;
  std::vector<NamedRow> rows_;
  std::vector<PetscInt> inner_, border_;
  std::vector<std::size_t> offsets_; // of the rows of inner_, without prescribed columns
  std::vector<PetscInt> columns_;
  std::vector<double> values_;
  double scale_ = 0.0; // largest of these
  std::unique_ptr<InnerFactor> factor_;
  std::vector<double> correction_, force_, loaded_;
  std::string fault_;
};
} // namespace pdx::solve
